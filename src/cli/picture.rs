//! `tyndall info` of a picture or of sums: how they were made.

use super::console::{Answer, say};
use crate::{
    error::{Error, Result},
    film::{exr, png},
    render::sums::file,
};
use serde_json::Value;
use std::path::Path;

/// What the file at `path` says of itself, if it is sums by its content, or a picture or sums by its name.
pub(super) fn made(path: &Path) -> Result<Option<Value>> {
    let end = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let text = match end.as_str() {
        _ if file::is_one(path) => return of_sums(path).map(Some),
        "exr" => exr::made(path)?,
        "png" => png::made(path)?,
        "sums" => return of_sums(path).map(Some),
        _ => return Ok(None),
    };
    let made = text.and_then(|text| serde_json::from_str(&text).ok());
    let refuse = || {
        let remedy = "name an .exr or .png file that tyndall render has written";
        Error::new(
            path.display(),
            "a picture that says how it was made",
            "none of tyndall's words in it",
            remedy,
        )
    };
    made.map(Some).ok_or_else(refuse)
}

fn of_sums(path: &Path) -> Result<Value> {
    let (sums, mut made) = file::read(path)?;
    let image = sums.kept().image();
    made["samples"] = sums.kept().samples().to_string().into();
    made["render_seconds"] = image.elapsed.as_secs_f64().into();
    made["relative_error"] = image.noise.map(|noise| noise.error).into();
    if let Some(reached) = image.reached {
        made["pixels_within_error"] = reached.share.into();
    }
    Ok(made)
}

/// Prints it.
pub(super) fn show(made: &Value, answer: &Answer) -> Result<()> {
    let text = |value: &Value| value.as_str().map_or_else(|| value.to_string(), str::to_owned);
    let mut lines = Vec::new();
    let all =
        made.as_object().into_iter().flatten().filter(|(name, _)| *name != "settings" && *name != "command");
    lines.extend(all.map(|(name, value)| format!("{name:20} {}", text(value))));
    let settings = made["settings"].as_object().into_iter().flatten();
    lines.extend(settings.map(|(name, value)| format!("{name:20} {}", text(value))));
    lines.push(format!("{:20} {}", "command", command(made)));
    say(&lines.join("\n"));
    answer.give(made)
}

/// The command line that makes the picture again.
fn command(made: &Value) -> String {
    let words = made["command"].as_array().into_iter().flatten().filter_map(Value::as_str);
    let words: Vec<&str> = ["tyndall"].into_iter().chain(words.skip(1)).collect();
    shlex::try_join(words).unwrap_or_default()
}
