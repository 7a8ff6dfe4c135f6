//! What a plugin is and what may be given to it, as a table in the plugin's own file: reading, checking, suggesting
//! and explaining all look here, so that no default and no range is written twice.

use super::{colour::Role, params::COLOR};
use std::fmt::{self, Display, Formatter};

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

/// Numbers that are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The lower limit.
    pub low: f64,
    /// The upper limit.
    pub high: f64,
    /// True for a limit that is not allowed itself.
    pub open: [bool; 2],
}

/// Every finite number.
pub const ANY: Range = Range { low: f64::MIN, high: f64::MAX, open: [false; 2] };

/// Numbers that f32 holds have this limit, which is not worth a word.
pub const MAX: f64 = f32::MAX as f64;

/// From `low` to `high`, both allowed.
pub const fn within(low: f64, high: f64) -> Range {
    Range { low, high, open: [false; 2] }
}

/// Between `low` and `high`, neither allowed.
pub const fn between(low: f64, high: f64) -> Range {
    Range { low, high, open: [true; 2] }
}

/// Above `low`, `high` allowed.
pub const fn above(low: f64, high: f64) -> Range {
    Range { low, high, open: [true, false] }
}

impl Range {
    /// True if `number` is allowed.
    pub fn contains(&self, number: f64) -> bool {
        let low = if self.open[0] { number > self.low } else { number >= self.low };
        low && if self.open[1] { number < self.high } else { number <= self.high }
    }

    /// True if there is an upper limit worth telling.
    pub fn is_bounded(&self) -> bool {
        self.high < MAX
    }

    /// What is allowed, after "a number"; to be told of `number`, which is not.
    fn told(&self, number: f64) -> String {
        let (low, high, is_above) = (plain(self.low), plain(self.high), number > self.high);
        match self.open {
            _ if *self == ANY => String::new(),
            [false, _] if !self.is_bounded() && !is_above => format!(" >= {low}"),
            [true, _] if !self.is_bounded() && !is_above => format!(" > {low}"),
            [false, false] => format!(" from {low} to {high}"),
            [true, true] => format!(" between {low} and {high} (both excluded)"),
            _ => format!(" above {low}, up to {high}"),
        }
    }
}

impl Display for Range {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(&self.told(self.low))
    }
}

/// A number in as few characters as tell it.
pub fn plain(number: f64) -> String {
    let size = number.abs();
    let is_short = size == 0.0 || (1e-4..1e7).contains(&size) || size.fract() == 0.0 && size < 1e12;
    if is_short { number.to_string() } else { format!("{number:e}") }
}

impl Parameter {
    const fn new(name: &'static str, kind: Kind, default: Default, about: &'static str) -> Self {
        Self { name, kind, unit: "", default, about, ours: false }
    }

    const fn unit(self, unit: &'static str) -> Self {
        Self { unit, ..self }
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

/// A number.
pub const fn number(
    name: &'static str,
    unit: &'static str,
    range: Range,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Number(range), default, about).unit(unit)
}

/// A number that f32 holds, >= 0.
pub const fn factor(name: &'static str, default: f64, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Number(within(0.0, MAX)), Is(default), about)
}

/// An index of refraction: a number or the name of a material.
pub const fn number_or_name(
    name: &'static str,
    range: Range,
    default: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::NumberOrName(range), Word(default), about)
}

/// A whole number.
pub const fn integer(name: &'static str, range: Range, default: Default, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Integer(range), default, about)
}

/// `true` or `false`.
pub const fn boolean(name: &'static str, default: bool, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Boolean, Default::Yes(default), about)
}

/// Text, which is `what`.
pub const fn text(
    name: &'static str,
    what: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Text(what), default, about)
}

/// One of a few words.
pub const fn choice(
    name: &'static str,
    words: &'static [&'static str],
    default: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Choice(words), Word(default), about)
}

/// A point or vector.
pub const fn vector(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Vector, default, about).unit(unit)
}

/// One number for all channels or three, which must be given.
pub const fn channels(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Channels, Required, about)
}

/// A transform, the identity where not given.
pub const fn transform(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Transform, Said("identity"), about)
}

/// A colour of matter.
pub const fn colour(
    name: &'static str,
    unit: &'static str,
    most: f64,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Colour(Role::Matter, most), default, about).unit(unit)
}

/// A colour of light.
pub const fn light(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Colour(Role::Light, f64::INFINITY), default, about).unit(unit)
}

/// A colour or texture of matter.
pub const fn texture(name: &'static str, most: f64, default: Default, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Matter, most), default, about)
}

/// A colour or texture of indices of refraction.
pub const fn index_texture(name: &'static str, most: f64, default: f64, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Index, most), Is(default), about)
}

/// A colour or texture of light.
pub const fn light_texture(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Light, f64::INFINITY), default, about).unit(unit)
}

/// A colour of matter, or a volume.
pub const fn volume(
    name: &'static str,
    unit: &'static str,
    most: f64,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Volume(Role::Matter, most), default, about).unit(unit)
}

/// A colour of light, or a volume.
pub const fn light_volume(name: &'static str, unit: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Volume(Role::Light, f64::INFINITY), Optional, about).unit(unit)
}

/// A spectrum of wavelengths and values.
pub const fn spectrum(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Spectrum, Optional, about)
}

/// The name of a file, which must be given. `name` ends with `filename`, by which it is known what a scene reads.
pub const fn file(name: &'static str, about: &'static str) -> Parameter {
    assert!(matches!(name.as_bytes(), [.., b'f', b'i', b'l', b'e', b'n', b'a', b'm', b'e']));
    Parameter::new(name, Kind::File, Required, about)
}

/// A plugin of the kind `tag`.
pub const fn object(name: &'static str, tag: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Object(tag), Optional, about)
}

/// Plugins of the kind `tag`, under any name.
pub const fn nested(tag: &'static str, default: Default, about: &'static str) -> Parameter {
    Parameter::new(tag, Kind::Nested, default, about)
}

/// A parameter that is accepted with a warning that it is not used, and why.
pub const fn ignored(name: &'static str, why: &'static str) -> Parameter {
    Parameter::new(name, Kind::Ignored { silent: false }, Optional, why)
}

/// A parameter that is accepted and cannot change what is rendered.
pub const fn silent(name: &'static str, why: &'static str) -> Parameter {
    Parameter::new(name, Kind::Ignored { silent: true }, Optional, why)
}

/// The words of a list of words with their meanings.
pub const fn words<const COUNT: usize, T>(meanings: &[(&'static str, T)]) -> [&'static str; COUNT] {
    let mut words = [""; COUNT];
    let mut index = 0;
    while index < COUNT {
        words[index] = meanings[index].0;
        index += 1;
    }
    words
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
