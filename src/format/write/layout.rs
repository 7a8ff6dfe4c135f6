//! JSON laid out: what fits on a line is put on one, the rest a line each.

/// A line is at most so wide, where it can be.
const WIDTH: usize = 100;

/// JSON to be laid out.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Json {
    /// A number, a truth value, or a string in quotes.
    Word(String),
    List(Vec<Json>),
    Map(Vec<(String, Json)>),
}

/// A string in quotes.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

impl Json {
    /// A string.
    pub(super) fn string(text: &str) -> Self {
        Self::Word(quoted(text))
    }

    /// The text of a file that holds it, which is spread over lines whatever its width.
    pub(super) fn file(&self) -> String {
        let mut text = String::new();
        self.open(&mut text, 0);
        text.push('\n');
        text
    }

    /// The text of an entry of a map: its key, and what it holds.
    pub(super) fn entry(key: &str, value: &Self) -> String {
        let mut text = format!("{}: ", quoted(key));
        let before = text.chars().count();
        value.lay(&mut text, 0, before);
        text
    }

    fn lay(&self, out: &mut String, indent: usize, before: usize) {
        let line = self.line();
        match self {
            Self::Word(_) => out.push_str(&line),
            _ if before + line.chars().count() < WIDTH && !self.is_deep() => out.push_str(&line),
            _ => self.open(out, indent),
        }
    }

    /// True for plugins that contain plugins: these are written on several lines to show the nesting.
    fn is_deep(&self) -> bool {
        let plugin = |value: &Self| matches!(value, Self::Map(entries) if !is_value(entries));
        matches!(self, Self::Map(entries) if entries.iter().any(|(_, value)| plugin(value)))
    }

    fn open(&self, out: &mut String, indent: usize) {
        let inner = indent + 2;
        let (left, right) = if let Self::Map(_) = self { ('{', '}') } else { ('[', ']') };
        out.push(left);
        let mut first = true;
        let mut start = |out: &mut String| {
            out.push_str(if std::mem::take(&mut first) { "\n" } else { ",\n" });
            out.push_str(&" ".repeat(inner));
        };
        match self {
            Self::Word(word) => out.push_str(word),
            Self::List(items) => items.iter().for_each(|item| {
                start(out);
                item.lay(out, inner, inner + 1);
            }),
            Self::Map(entries) => entries.iter().for_each(|(key, value)| {
                start(out);
                let key = quoted(key);
                let before = inner + key.chars().count() + 3;
                out.push_str(&key);
                out.push_str(": ");
                value.lay(out, inner, before);
            }),
        }
        out.push('\n');
        out.push_str(&" ".repeat(indent));
        out.push(right);
    }

    fn line(&self) -> String {
        match self {
            Self::Word(word) => word.clone(),
            Self::List(items) => {
                format!("[{}]", items.iter().map(Self::line).collect::<Vec<_>>().join(", "))
            }
            Self::Map(entries) => {
                let entry = |(key, value): &(String, Self)| format!("{}: {}", quoted(key), value.line());
                format!("{{ {} }}", entries.iter().map(entry).collect::<Vec<_>>().join(", "))
            }
        }
    }
}

fn is_value(entries: &[(String, Json)]) -> bool {
    let Some((_, Json::Word(kind))) = entries.first() else { return false };
    ["\"rgb\"", "\"spectrum\"", "\"ref\"", "\"keyframes\""].contains(&kind.as_str())
}
