//! `$name` parameters: declared with a default in the scene, overridden by the user, put in place of `$name`.

use crate::{
    description::nearest,
    error::{Error, Result},
};

/// All parameters known so far and their values.
pub(super) struct Parameters {
    entries: Vec<Entry>,
}

struct Entry {
    name: String,
    value: String,
    used: bool,
    by_user: bool,
}

/// Why a text cannot be substituted; the caller adds where it is.
#[derive(Debug)]
pub(super) struct Unfit {
    /// What would have been right.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// What to do about it.
    pub remedy: String,
}

/// A text may grow to so many bytes. Parameters in the defaults of others could otherwise double it without end.
const LONGEST: usize = 1 << 20;

fn too_long(after: &str) -> Unfit {
    let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').take(80).collect();
    Unfit {
        expected: format!("a text of at most {LONGEST} bytes when parameters are in place"),
        found: format!("more by ${name}"),
        remedy: "shorten the defaults that name one another".into(),
    }
}

/// `text` so escaped that substitution gives it back.
pub(super) fn escaped(text: &str) -> String {
    text.replace('$', "\\$")
}

impl Parameters {
    /// What the user gave; a name twice is an error.
    pub(super) fn new(definitions: &[(String, String)]) -> Result<Self> {
        let mut parameters = Self { entries: Vec::new() };
        for (name, value) in definitions {
            if name.is_empty() || parameters.get(name).is_some() {
                let found = format!("-D {name}={value}");
                let remedy = "give each parameter once, as -D name=value";
                return Err(Error::new("the command line", "a parameter not given before", found, remedy));
            }
            parameters.insert(name, value, true);
        }
        Ok(parameters)
    }

    /// The scene's own default for `name`; a value already given is kept.
    pub(super) fn declare(&mut self, name: &str, default: &str) {
        if self.get(name).is_none() {
            self.insert(name, default, false);
        }
    }

    /// All names and values, in the order of the names.
    pub(super) fn values(&self) -> Vec<(&str, &str)> {
        let entries = self.entries.iter();
        let mut values: Vec<_> = entries.map(|entry| (entry.name.as_str(), entry.value.as_str())).collect();
        values.sort_unstable();
        values
    }

    fn get(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// True if a parameter is called exactly `name`.
    pub(super) fn is_name(&self, name: &str) -> bool {
        self.get(name).is_some()
    }

    /// Longest names first, so that `$radius` is not taken for `$r` followed by `adius`.
    fn insert(&mut self, name: &str, value: &str, by_user: bool) {
        let place = self.entries.partition_point(|entry| entry.name.len() >= name.len());
        let (name, value) = (name.to_owned(), value.to_owned());
        self.entries.insert(place, Entry { name, value, used: false, by_user });
    }

    /// `text` with every `$name` replaced; `\$` is a dollar sign.
    pub(super) fn substitute(&mut self, text: &str) -> std::result::Result<String, Unfit> {
        let mut result = String::new();
        let mut rest = text;
        while let Some(at) = rest.find('$') {
            let (before, after) = (&rest[..at], &rest[at + 1..]);
            if let Some(before) = before.strip_suffix('\\') {
                result.extend([before, "$"]);
                rest = after;
                continue;
            }
            let entry = self.entries.iter_mut().find(|entry| after.starts_with(&entry.name));
            let Some(entry) = entry else { return Err(self.undefined(after)) };
            entry.used = true;
            result.extend([before, &entry.value]);
            rest = &after[entry.name.len()..];
            if result.len() > LONGEST {
                return Err(too_long(after));
            }
        }
        Ok(result + rest)
    }

    fn undefined(&self, after: &str) -> Unfit {
        let end = after.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(after.len());
        let name = after[..end].to_owned();
        let known: Vec<_> = self.values().into_iter().map(|(name, _)| name).collect();
        let hint = nearest(&name, &known);
        let remedy = format!(
            "{hint}declare a default for it before this place, or give -D {name}=...; known: {}",
            if known.is_empty() { "none".into() } else { known.join(", ") }
        );
        Unfit { expected: "a defined parameter".into(), found: format!("${name}"), remedy }
    }

    /// Everything the user gave must have been used.
    pub(super) fn finish(&self) -> Result<()> {
        let Some(idle) = self.entries.iter().find(|entry| entry.by_user && !entry.used) else {
            return Ok(());
        };
        let Entry { name, value, .. } = idle;
        let known: Vec<_> = self.entries.iter().filter(|e| e.used).map(|e| e.name.as_str()).collect();
        let list = if known.is_empty() { "none".into() } else { known.join(", ") };
        Err(Error::new(
            "the command line",
            "a parameter that the scene uses",
            format!("-D {name}={value}"),
            format!("{}used by this scene: {list}", nearest(name, &known)),
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(pairs: &[(&str, &str)]) -> Parameters {
        let pairs: Vec<_> = pairs.iter().map(|(n, v)| (n.to_string(), v.to_string())).collect();
        Parameters::new(&pairs).unwrap()
    }

    fn substituted(parameters: &mut Parameters, text: &str) -> String {
        parameters.substitute(text).unwrap_or_else(|unfit| panic!("{unfit:?}"))
    }

    #[test]
    fn the_longest_name_wins_and_escapes_stay() {
        let mut p = with(&[("r", "1"), ("radius", "2")]);
        assert_eq!(substituted(&mut p, "$radius,$r,\\$r,$r$r"), "2,1,$r,11");
    }

    #[test]
    fn users_override_defaults_and_hear_of_idle_ones() {
        let mut p = with(&[("a", "user")]);
        p.declare("a", "scene");
        p.declare("b", "idle defaults are fine");
        assert!(p.finish().unwrap_err().found.contains("-D a=user"));
        assert_eq!(substituted(&mut p, "$a"), "user");
        p.finish().unwrap();
    }

    #[test]
    fn defaults_cannot_grow_without_end() {
        let mut p = with(&[("x0", "0123456789")]);
        let grown = (1..10).find_map(|i| {
            let text = format!("$x{}", i - 1).repeat(10);
            let value = p.substitute(&text);
            value.map(|value| p.declare(&format!("x{i}"), &value)).err()
        });
        assert!(grown.unwrap().expected.contains("at most"));
    }

    #[test]
    fn an_undefined_name_comes_with_the_nearest() {
        let undefined = with(&[("density", "1")]).substitute("x$densty!").unwrap_err();
        assert_eq!(undefined.found, "$densty");
        assert!(undefined.remedy.contains("did you mean \"density\""));
    }
}
