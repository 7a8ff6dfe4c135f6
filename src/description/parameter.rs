//! What a plugin is and what may be given to it, as a table in the plugin's own file: reading, checking, suggesting
//! and explaining all look here, so that no default and no range is written twice.

mod constructors;
mod range;

pub use constructors::*;
pub use range::*;

use super::{colour::Role, spelling::COLOR};

/// A plugin: its table, and how it is built.
#[derive(Clone, Copy, Debug)]
pub struct Plugin<B> {
    /// What it is, and what may be given to it.
    pub table: Table,
    /// The builder.
    pub build: B,
}

/// What a plugin is, and what may be given to it.
#[derive(Clone, Copy, Debug)]
pub struct Table {
    /// What it is, in a sentence.
    pub about: &'static str,
    /// Its parameters, in groups: several tables share some.
    pub groups: &'static [&'static [Parameter]],
}

impl Table {
    /// All rows.
    pub fn rows(&self) -> impl Iterator<Item = &'static Parameter> + use<> {
        self.groups.iter().copied().flatten()
    }

    /// The row of the parameter `name`; of nested plugins, [`Self::nested`] tells.
    pub fn find(&self, name: &str) -> Option<&'static Parameter> {
        self.rows().find(|row| row.name == name && !matches!(row.kind, Kind::Nested))
    }

    /// The row of nested plugins of the kind `tag`.
    pub fn nested(&self, tag: &str) -> Option<&'static Parameter> {
        self.rows().find(|row| row.name == tag && matches!(row.kind, Kind::Nested))
    }

    /// The names that a user may write.
    pub fn names(&self) -> Vec<&'static str> {
        let named = |row: &&Parameter| !matches!(row.kind, Kind::Nested | Kind::Ignored { .. });
        let mut names: Vec<_> = self.rows().filter(named).map(|row| row.name).collect();
        names.sort_unstable();
        names
    }
}

/// A row of a table: one parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// As written in a scene; of nested plugins, whose name is free, their kind.
    pub name: &'static str,
    /// What may be given.
    pub kind: Kind,
    /// The unit; empty for none.
    pub unit: &'static str,
    /// What counts where it is not given.
    pub default: Default,
    /// What it does, in a sentence.
    pub about: &'static str,
    /// True if a plugin of Mitsuba's has it in Tyndall only.
    pub ours: bool,
}

/// What may be given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// A number.
    Number(Range),
    /// A number, or the name of a substance that has it.
    NumberOrName(Range),
    /// A whole number.
    Integer(Range),
    /// `true` or `false`.
    Boolean,
    /// Text, in words.
    Text(&'static str),
    /// One of a few words.
    Choice(&'static [&'static str]),
    /// Three numbers.
    Vector,
    /// One number for all channels, or three.
    Channels,
    /// A transform.
    Transform,
    /// A colour, with channels up to a number.
    Colour(Role, f64),
    /// The same, or a texture.
    Texture(Role, f64),
    /// The same, or a volume.
    Volume(Role, f64),
    /// A spectrum of wavelengths and values.
    Spectrum,
    /// The name of a file.
    File,
    /// A plugin of the kind given by its tag.
    Object(&'static str),
    /// Plugins of the kind of the row's name, under any name.
    Nested,
    /// Accepted, and not used, for the reason that `about` gives.
    Ignored {
        /// Without a warning: it cannot change what is rendered.
        silent: bool,
    },
}

/// What counts where a parameter is not given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Default {
    /// Nothing: it must be given.
    Required,
    /// Nothing: what it does is not done.
    Optional,
    /// A number, or a colour that is grey.
    Is(f64),
    /// A truth value.
    Yes(bool),
    /// A word.
    Word(&'static str),
    /// A point or vector.
    At([f64; 3]),
    /// What the builder makes of other parameters, in words.
    Said(&'static str),
}
pub use self::Default::{At, Is, Optional, Required, Said, Word};

impl Parameter {
    const fn new(name: &'static str, kind: Kind, default: Default, about: &'static str) -> Self {
        Self { name, kind, unit: "", default, about, ours: false }
    }

    const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
    }

    /// That must be given.
    pub const fn required(self) -> Self {
        Self { default: Required, ..self }
    }

    /// Of a plugin of Mitsuba's, but not in Mitsuba.
    pub const fn ours(self) -> Self {
        Self { ours: true, ..self }
    }

    /// True if it is accepted without effect.
    pub fn is_ignored(&self) -> bool {
        matches!(self.kind, Kind::Ignored { .. })
    }

    /// With a default that the builder makes of other parameters.
    pub const fn said(self, default: &'static str) -> Self {
        Self { default: Said(default), ..self }
    }

    /// The numbers that are allowed.
    pub fn range(&self) -> Range {
        match self.kind {
            Kind::Number(range) | Kind::NumberOrName(range) | Kind::Integer(range) => range,
            Kind::Colour(_, most) | Kind::Texture(_, most) | Kind::Volume(_, most) => within(0.0, most),
            _ => ANY,
        }
    }

    /// What is expected, for errors: of `found`, if that was a number out of range.
    pub fn expected(&self, found: f64) -> String {
        let range = self.range().told(found);
        let text = match self.kind {
            Kind::Number(ANY) => "a finite number".into(),
            Kind::Number(_) => format!("a number{range}"),
            Kind::NumberOrName(_) => format!("a number{range} or the name of a material"),
            Kind::Integer(_) => format!("an integer{range}"),
            Kind::Boolean => "a boolean".into(),
            Kind::Text(what) => what.into(),
            Kind::Choice(words) => format!("one of {}", words.join(", ")),
            Kind::Vector => "three finite numbers".into(),
            Kind::Channels => "a number or three".into(),
            Kind::Transform => "a transform".into(),
            Kind::Colour(_, most) if most < MAX => format!("a colour{range}"),
            Kind::Texture(_, most) if most < MAX => format!("a colour or texture{range}"),
            Kind::Colour(..) => COLOR.into(),
            Kind::Texture(..) => "a colour or texture".into(),
            Kind::Volume(_, most) if most < MAX => format!("a colour or volume{range}"),
            Kind::Volume(..) => "a colour or volume".into(),
            Kind::Spectrum => "a spectrum of wavelength:value pairs".into(),
            Kind::File => "a file name".into(),
            Kind::Object(tag) => format!("a {tag}"),
            Kind::Nested => format!("a nested {}", self.name),
            Kind::Ignored { .. } => "nothing".into(),
        };
        if self.unit.is_empty() { text } else { format!("{text} [{}]", self.unit) }
    }
}

/// Rows that several tables share. The constructors above are in scope.
macro_rules! rows {
    ($($row:expr),* $(,)?) => {{
        #[allow(unused_imports, clippy::wildcard_imports, reason = "which rows there are is the table's matter")]
        use $crate::description::parameter::*;
        &[$($row),*]
    }};
}
pub(crate) use rows;

/// A table: a sentence, rows, and groups of rows that it shares. The constructors above are in scope.
macro_rules! table {
    ($about:expr; $($row:expr),* $(,)? $(; $($group:expr),+)?) => {
        $crate::description::parameter::Table {
            about: $about,
            groups: &[$crate::description::parameter::rows![$($row),*] $($(, $group)+)?],
        }
    };
}
pub(crate) use table;
