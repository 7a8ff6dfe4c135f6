//! Registries: the names that users write, and what each refers to. Whatever lists, looks up or suggests names reads
//! these rows. And the enum of all models of a kind, whose methods are those of the model.

use super::{
    library::Library,
    object::Object,
    parameter::{Plugin, Table},
    params::Params,
};
use crate::error::{Error, Result};

/// Names of one kind, and what each refers to.
#[derive(Clone, Copy, Debug)]
pub struct Registry<V: 'static> {
    /// With its article, for errors: `a bsdf`.
    kind: &'static str,
    rows: &'static [(&'static str, V)],
}

/// How a plugin is built from its parameters.
pub type Build<T> = fn(&Params<'_>) -> Result<T>;

impl<V> Registry<V> {
    /// Names of `kind`, which comes with its article.
    pub const fn new(kind: &'static str, rows: &'static [(&'static str, V)]) -> Self {
        Self { kind, rows }
    }

    /// All names, in order.
    pub fn names(&self) -> Vec<&'static str> {
        self.rows.iter().map(|(name, _)| *name).collect()
    }

    /// What `name` refers to.
    pub fn get(&self, name: &str) -> Option<&'static V> {
        self.rows.iter().find(|(known, _)| *known == name).map(|(_, value)| value)
    }

    /// True if `object` is a plugin of this kind.
    pub fn has(&self, object: &Object) -> bool {
        self.get(&object.plugin).is_some()
    }

    /// What the plugin name of `object` refers to.
    pub fn find(&self, object: &Object) -> Result<&'static V> {
        self.row(object).map(|(_, value)| value)
    }

    /// The plugin name of `object`, and what it refers to.
    pub fn row(&self, object: &Object) -> Result<&'static (&'static str, V)> {
        self.rows.iter().find(|(known, _)| *known == object.plugin).ok_or_else(|| {
            let remedy = suggest(&object.plugin, "known", &self.names());
            let found = format!("\"{}\"", object.plugin);
            Error::new(&object.location, format!("the type of {}", self.kind), found, remedy)
        })
    }
}

impl<B> Registry<Plugin<B>> {
    /// Every name with its table.
    pub fn tables(&self) -> impl Iterator<Item = (&'static str, &'static Table)> + use<B> {
        self.rows.iter().map(|(name, plugin)| (*name, &plugin.table))
    }

    /// The parameters of `object`, to be read by its builder, which comes with them.
    pub fn read<'a>(&self, object: &'a Object, library: &'a Library) -> Result<(Params<'a>, &'static B)> {
        let plugin = self.find(object)?;
        Ok((Params::new(object, library, &plugin.table), &plugin.build))
    }
}

impl<T> Registry<Plugin<Build<T>>> {
    /// Builds `object` by its plugin name; a parameter that its builder does not read is an error.
    pub fn build(&self, object: &Object, library: &Library) -> Result<T> {
        let (params, build) = self.read(object, library)?;
        let built = build(&params)?;
        params.finish()?;
        Ok(built)
    }
}

/// Makes an enum with a variant a model, named as the model, and dispatches the methods of their trait. The trait is
/// in scope where the rows are; methods that are not listed are the trait's own.
macro_rules! models {
    ($(#[$doc:meta])* $any:ident: $contract:ident $models:tt
     $($(#[$attribute:meta])* fn $method:ident($($argument:ident: $type:ty),*) -> $out:ty;)*) => {
        $crate::description::registry::models!(@enum $(#[$doc])* $any $models);
        impl $contract for $any {
            $($crate::description::registry::models! {
                @method $models $(#[$attribute])* fn $method [$($argument: $type),*] ($($argument),*) -> $out
            })*
        }
    };
    (@enum $(#[$doc:meta])* $any:ident [$($model:ident)*]) => {
        $(#[$doc])*
        #[derive(Clone, Debug)]
        #[expect(missing_docs, reason = "each variant is the model of its name, documented there")]
        pub enum $any {
            $($model($model),)*
        }

        $(impl From<$model> for $any {
            fn from(model: $model) -> Self {
                Self::$model(model)
            }
        })*
    };
    (@method [$($model:ident)*] $(#[$attribute:meta])*
     fn $method:ident [$($signature:tt)*] $arguments:tt -> $out:ty) => {
        $(#[$attribute])*
        fn $method(&self, $($signature)*) -> $out {
            match self { $(Self::$model(model) => model.$method $arguments,)* }
        }
    };
}
pub(crate) use models;

/// Maximum number of names listed in a message.
const LISTED: usize = 24;

/// The known name closest to `found`, if one is close, and the names that are known after `what` ("known",
/// "known ids"); of very many names only those that look most like it.
pub fn suggest(found: &str, what: &str, known: &[&str]) -> String {
    let mut shown = known.to_vec();
    if known.len() > LISTED {
        shown.sort_by_key(|name| (strsim::damerau_levenshtein(found, name), *name));
        shown.truncate(LISTED / 2);
    }
    let list = if known.is_empty() { "none".into() } else { shown.join(", ") };
    let rest = match known.len() - shown.len() {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{}{what}: {list}{rest}", nearest(found, known))
}

/// "did you mean ...? " for the known name closest to `found`; empty where none is close.
pub fn nearest(found: &str, known: &[&str]) -> String {
    // Whether a name is written in camel case or with underscores is no great distance.
    let plain = |name: &str| name.replace(['_', '-'], "").to_lowercase();
    let between = |a: &str, b: &str| {
        strsim::damerau_levenshtein(a, b).min(1 + strsim::damerau_levenshtein(&plain(a), &plain(b)))
    };
    known
        .iter()
        .map(|name| (between(found, name), name))
        .min()
        .filter(|(distance, name)| *distance <= 1 + name.len().min(found.len()) / 3)
        .map(|(_, name)| format!("did you mean \"{name}\"? "))
        .unwrap_or_default()
}
