//! What the page's script knows: the texts that it shows of each point.

use super::{
    figures,
    measure::{AXES, MEASURES},
};
use crate::{
    analysis::study::outcome::{ContenderOutcome, Outcome, Point},
    error::{Error, Result},
};
use serde_json::{Map, Value, json};

/// JSON that may be put in a script element: nothing in it can end that.
pub(super) fn json(outcome: &Outcome) -> Result<String> {
    let scene = |contenders: &Vec<ContenderOutcome>| contenders.iter().map(series).collect::<Vec<_>>();
    let scenes: Vec<_> = outcome.scenes.iter().map(|s| scene(&s.contenders)).collect();
    let measures: Map<String, Value> = MEASURES
        .iter()
        .map(|m| (m.key.into(), json!({"name": m.name, "slope": figures::number(m.slope)})))
        .collect();
    let axes: Map<String, Value> = AXES.iter().map(|axis| (axis.key.into(), json!(axis.name))).collect();
    let all =
        json!({"measures": measures, "axes": axes, "headroom": super::tone::HEADROOM, "scenes": scenes});
    let text = serde_json::to_string(&all).map_err(|error| {
        Error::new("study.html", "numbers that JSON can hold", error.to_string(), "report this study.json")
    })?;
    Ok(harmless(&text))
}

/// `<` could begin an end tag or a comment; outside of strings JSON has none of these characters.
fn harmless(json: &str) -> String {
    json.replace('<', "\\u003c")
        .replace('>', "\\u003e")
        .replace('&', "\\u0026")
        .replace('\u{2028}', "\\u2028")
        .replace('\u{2029}', "\\u2029")
}

fn series(contender: &ContenderOutcome) -> Value {
    json!({"name": contender.name, "points": contender.points.iter().map(point).collect::<Vec<_>>()})
}

/// Every number as a text.
fn point(point: &Point) -> Value {
    let measured = MEASURES.iter().map(|measure| {
        let value = (measure.of)(point);
        let text = format!("{} {}", figures::number(value.mean), figures::ends(value));
        (measure.key.to_owned(), Value::String(text))
    });
    let mut texts: Map<String, Value> = measured.collect();
    let cpu = point.cpu_seconds.map(|cpu| format!("{} CPU s", figures::number(cpu.mean)));
    let times: Vec<String> = [figures::seconds(point.seconds.mean)].into_iter().chain(cpu).collect();
    texts.insert("seconds".into(), json!(times.join(", ")));
    texts.insert("samples".into(), json!(format!("{} spp", figures::count(point.samples))));
    Value::Object(texts)
}

#[cfg(test)]
mod tests {
    #[test]
    fn no_text_can_leave_the_script() {
        let text = super::harmless(r#"["</script><!--", "\u2028 &amp;"]"#);
        assert!(!text.contains(['<', '>', '&']));
        let back: Vec<String> = serde_json::from_str(&text).unwrap();
        assert_eq!(back, ["</script><!--", "\u{2028} &amp;"]);
    }
}
