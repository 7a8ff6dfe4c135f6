//! Why a reference can be trusted, in sentences: how large its own error is and how that is known, what part of the
//! contenders' errors it makes, and who agrees with it that is made otherwise.

use super::outcome::{Apart, ContenderOutcome, SceneOutcome};

/// The sentences, with numbers as `number` writes them.
pub fn sentences(scene: &SceneOutcome, number: fn(f64) -> String) -> Vec<String> {
    let mut all = vec![own(scene, number)];
    if let Some(apart) = scene.reference.apart {
        let apart = number(apart);
        all.push(format!(
            "The means of its renderers are {apart} standard errors apart, as chance makes them."
        ));
    }
    all.extend(agreement(scene, number));
    all
}

fn own(scene: &SceneOutcome, number: fn(f64) -> String) -> String {
    let Some(own) = scene.reference.own_relmse else {
        return "The reference's own relMSE is not known.".to_owned();
    };
    let by = scene.reference.known_by.as_ref().map_or(String::new(), |by| format!(", by {by}"));
    let share = share(scene, own, number).map_or(String::new(), |share| format!("; {share}"));
    format!("The reference's own relMSE is {}{by}{share}.", number(own))
}

/// What part of the contenders' errors the reference's `own` is.
fn share(scene: &SceneOutcome, own: f64, number: fn(f64) -> String) -> Option<String> {
    let last = scene.contenders.iter().filter_map(|contender| contender.points.last());
    let shares = last.map(|point| 100.0 * own / point.relmse.mean).filter(|share| share.is_finite());
    let (least, most) =
        shares.fold((f64::INFINITY, 0.0_f64), |(least, most), share| (least.min(share), most.max(share)));
    match (number(least), number(most)) {
        _ if least == f64::INFINITY => None,
        (least, most) if least == most => {
            Some(format!("that is {most} % of a contender's error at the last budget"))
        }
        (least, most) => {
            Some(format!("that is {least} % to {most} % of the contenders' errors at the last budget"))
        }
    }
}

/// What contenders that are made otherwise say to its mean.
fn agreement(scene: &SceneOutcome, number: fn(f64) -> String) -> Vec<String> {
    let is_other = |contender: &&ContenderOutcome| !scene.reference.like.contains(&contender.name);
    let others = scene.contenders.iter().filter(is_other);
    let others: Vec<(&str, Apart)> = others.filter_map(|one| Some((one.name.as_str(), one.apart?))).collect();
    if others.is_empty() {
        let is_known = scene.contenders.iter().any(|contender| contender.apart.is_some());
        let nobody = "No contender is made otherwise than the reference: none can confirm its mean.";
        return is_known.then(|| nobody.to_owned()).into_iter().collect();
    }
    let (agree, differ): (Vec<_>, Vec<_>) = others.into_iter().partition(|(_, apart)| apart.is_chance());
    let said = |which: Vec<(&str, Apart)>, says: &str| {
        let who: Vec<String> =
            which.iter().map(|(name, apart)| format!("{name} ({})", number(apart.errors))).collect();
        (!who.is_empty()).then(|| format!("{says} {}.", who.join(", ")))
    };
    let agree =
        said(agree, "Contenders whose mean agrees with the reference's, and standard errors between them:");
    let differ = said(differ, "Contenders whose mean differs by more than chance, in standard errors:");
    agree.into_iter().chain(differ).collect()
}
