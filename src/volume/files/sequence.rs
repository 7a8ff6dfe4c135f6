//! Numbered files, one to a frame: `smoke_####.vdb` or `smoke_%04d.vdb`.

use super::{Problem, Result};
use crate::description::Object;
use std::path::{Path, PathBuf};

/// No more runs of frames than these are listed.
const LISTED: usize = 8;

/// More digits than these number no frame.
const MOST_DIGITS: usize = 9;

/// Files whose names differ in a number.
#[derive(Clone, Debug, PartialEq)]
pub struct Sequence {
    folder: PathBuf,
    prefix: String,
    suffix: String,
    /// Numbers of fewer digits are filled up with zeros.
    digits: usize,
    clock: Clock,
}

/// Which frame is shown when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Frames per second.
    pub fps: f64,
    /// The frame at the time 0; of none, the first that there is.
    pub first: Option<i64>,
}

impl Clock {
    /// Frames per second where nothing is said.
    pub const FPS: f64 = 24.0;

    /// As a plugin states it, whose parameters need not be right.
    pub fn of(object: &Object) -> Self {
        let fps = object.number("fps").unwrap_or(Self::FPS);
        Self { fps, first: object.number("first_frame").map(|frame| frame as i64) }
    }
}

/// Before, of how many digits, and after the number that a pattern stands for: `#`s, or printf's `%d` or `%04d`.
fn pattern(name: &str) -> Option<(&str, usize, &str)> {
    if let Some(start) = name.find('#') {
        let rest = name[start..].trim_start_matches('#');
        return Some((&name[..start], name.len() - start - rest.len(), rest));
    }
    let (prefix, rest) = name.split_once('%')?;
    let (digits, suffix) = rest.split_once('d')?;
    let digits = if digits.is_empty() { 1 } else { digits.strip_prefix('0')?.parse().ok()? };
    Some((prefix, digits, suffix)).filter(|_| (1..=MOST_DIGITS).contains(&digits))
}

impl Sequence {
    /// The sequence that `path` stands for, shown by `clock`; none of the name of a file, be it a strange one.
    pub fn new(path: &Path, clock: Clock) -> Option<Self> {
        let name = path.file_name()?.to_str()?;
        let (prefix, digits, suffix) = pattern(name).filter(|_| !path.is_file())?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        Some(Self { folder, prefix: prefix.to_owned(), suffix: suffix.to_owned(), digits, clock })
    }

    /// The name of the file of a frame.
    pub fn name(&self, frame: i64) -> String {
        let Self { prefix, suffix, digits, .. } = self;
        format!("{prefix}{frame:0digits$}{suffix}")
    }

    /// All frames that there are, in order.
    pub fn frames(&self) -> Vec<i64> {
        let names = std::fs::read_dir(self.folder_to_list()).into_iter().flatten().flatten();
        let mut frames: Vec<_> = names.filter_map(|entry| self.number(entry.file_name().to_str()?)).collect();
        frames.sort_unstable();
        frames
    }

    /// The file of the last of them.
    pub fn last(&self) -> Result<PathBuf> {
        let last = self.frames().pop().ok_or_else(|| self.nothing())?;
        Ok(self.folder.join(self.name(last)))
    }

    /// Their files.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        self.frames().into_iter().map(|frame| self.folder.join(self.name(frame)))
    }

    fn folder_to_list(&self) -> PathBuf {
        if self.folder.as_os_str().is_empty() { PathBuf::from(".") } else { self.folder.clone() }
    }

    fn number(&self, name: &str) -> Option<i64> {
        let digits = name.strip_prefix(self.prefix.as_str())?.strip_suffix(self.suffix.as_str())?;
        let is_number = digits.bytes().all(|byte| byte.is_ascii_digit()) && digits.len() <= MOST_DIGITS;
        let frame = digits.parse().ok().filter(|_| is_number)?;
        (self.name(frame) == name).then_some(frame)
    }

    /// The file that is shown at `time` (s): that of the nearest frame.
    pub fn at(&self, time: f64) -> Result<PathBuf> {
        let Clock { fps, first } = self.clock;
        let shift = (time * fps).round();
        let frame = |first: i64| first.saturating_add(shift as i64);
        // Where it is said which frame is meant, no folder need be listed.
        let stated = first.map(|first| self.folder.join(self.name(frame(first))));
        if let Some(path) = stated.filter(|path| path.is_file()) {
            return Ok(path);
        }
        let frames = self.frames();
        let Some(first) = first.or(frames.first().copied()) else { return Err(self.nothing()) };
        let wanted = frame(first);
        if frames.contains(&wanted) {
            return Ok(self.folder.join(self.name(wanted)));
        }
        Err(self.missing(wanted, &frames, format!("{time} s x {fps} frames per second after frame {first}")))
    }

    fn pattern(&self) -> String {
        format!("{}{}{}", self.prefix, "#".repeat(self.digits), self.suffix)
    }

    fn nothing(&self) -> Problem {
        let (pattern, folder) = (self.pattern(), self.folder_to_list());
        let expected = format!("files like {}", self.name(1));
        let remedy = format!("none is in {}; paths start at the folder of the scene file", folder.display());
        Problem::new(expected, format!("none for \"{pattern}\""), remedy)
    }

    fn missing(&self, wanted: i64, frames: &[i64], why: String) -> Problem {
        let expected = format!("{}, the frame at {why}", self.name(wanted));
        let found =
            if frames.is_empty() { "no frame".to_owned() } else { format!("frames {}", runs(frames)) };
        let remedy = "correct \"first_frame\", \"fps\" or the time, or write the frames that are missing";
        Problem::new(expected, found, remedy)
    }
}

/// Numbers as runs: 1 to 10, 12 and 14 to 20.
pub fn runs(frames: &[i64]) -> String {
    let runs: Vec<&[i64]> = frames.chunk_by(|a, b| *b == a + 1).collect();
    let one = |run: &&[i64]| match run {
        [only] => only.to_string(),
        _ => format!("{} to {}", run[0], run[run.len() - 1]),
    };
    let mut texts: Vec<_> = runs.iter().take(LISTED).map(one).collect();
    if runs.len() > LISTED {
        texts.push(format!("others up to {}", frames[frames.len() - 1]));
    }
    match texts.pop() {
        Some(last) if texts.is_empty() => last,
        last => format!("{} and {}", texts.join(", "), last.unwrap_or_default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn patterns_are_hashes_or_printf_s() {
        assert_eq!(pattern("a_####.vdb"), Some(("a_", 4, ".vdb")));
        assert_eq!(pattern("#"), Some(("", 1, "")));
        assert_eq!(pattern("a%04d.vdb"), Some(("a", 4, ".vdb")));
        assert_eq!(pattern("a%d.vdb"), Some(("a", 1, ".vdb")));
        for plain in ["a.vdb", "50%dense", "100%.vdb", "a%04f.vdb", "a%099d.vdb", "a%00d"] {
            assert!(pattern(plain).is_none_or(|(_, digits, _)| digits == 1), "{plain}");
        }
    }

    #[test]
    fn the_nearest_frame_is_shown_and_a_missing_one_named() {
        let folder = tempfile::tempdir().unwrap();
        for name in
            ["a_0009.vdb", "a_0010.vdb", "a_0011.vdb", "a_0013.vdb", "a_12.vdb", "a_x.vdb", "a_10000.vdb"]
        {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let path = folder.path().join("a_####.vdb");
        let sequence = |first| Sequence::new(&path, Clock { fps: 24.0, first }).unwrap();
        assert_eq!(sequence(None).frames(), [9, 10, 11, 13, 10000]);
        let at = |time: f64, first| {
            let path = sequence(first).at(time)?;
            Ok(path.file_name().unwrap().to_str().unwrap().to_owned())
        };
        // Every frame's time, whatever its rounding.
        assert_eq!(at(0.0, None), Ok("a_0009.vdb".to_owned()));
        assert_eq!(at(1.0 / 24.0, None), Ok("a_0010.vdb".to_owned()));
        assert_eq!(at(0.07, None), Ok("a_0011.vdb".to_owned()));
        assert_eq!(at(0.1, None), Ok("a_0011.vdb".to_owned()));
        assert_eq!(at(10.0 / 24.0, Some(1)), Ok("a_0011.vdb".to_owned()));
        assert_eq!(at(9999.0 / 24.0, Some(1)), Ok("a_10000.vdb".to_owned()));
        let missing: Problem = at(11.0 / 24.0, Some(1)).unwrap_err();
        assert!(missing.expected.contains("a_0012.vdb"), "{missing:?}");
        assert_eq!(missing.found, "frames 9 to 11, 13 and 10000");
        assert!(at(-1.0, None).is_err() && at(1e300, None).is_err());
    }

    #[test]
    fn a_file_of_that_very_name_is_no_pattern() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("take #2.vdb");
        let clock = Clock { fps: 24.0, first: None };
        assert!(Sequence::new(&path, clock).is_some());
        fs::write(&path, "").unwrap();
        assert_eq!(Sequence::new(&path, clock), None);
        let none = Sequence::new(&folder.path().join("b_%03d.vdb"), clock).unwrap();
        assert_eq!(none.at(0.0).unwrap_err().found, "none for \"b_###.vdb\"");
    }
}
