//! A whole study: plan, reference, turns, sums; scene by scene, from wherever it was stopped.

use super::{
    conditions,
    contender::{Contender, Enter, Entry, How},
    plan::{self, Part, Plan, ScenePlan},
    question::{Effort, Question, Wanted},
    reference::{self, Truth},
    store::Store,
    summary::{self, Turns},
    table,
    unit::{self, Slot, Unit},
};
use crate::{
    analysis::{
        picture::Picture,
        study::outcome::{Conditions, ContenderOutcome, Outcome, Reference, SceneOutcome},
    },
    error::{Error, Result},
    transport::coverage,
};
use std::path::Path;

/// What the outcome holds besides what was found.
#[derive(Clone, Debug)]
pub struct Signature {
    /// The command that makes the study again.
    pub command: String,
    /// Processor and threads.
    pub machine: String,
    /// Of every interval.
    pub confidence: f64,
}

/// How far a study is.
#[derive(Clone, Debug)]
pub struct Progress {
    /// In [0, 1].
    pub share: f64,
    /// What is being done.
    pub doing: String,
    /// This was there before: it took no time.
    pub is_old: bool,
}

/// Runs the study of `question` in `folder`, or what is left of it, and writes `study.json` and `study.csv`.
pub fn run(
    folder: &Path,
    restart: bool,
    question: &Question,
    signature: &Signature,
    enter: &mut Enter<'_>,
    notify: &mut (dyn FnMut(&Progress) + Send),
) -> Result<Outcome> {
    let (store, plan) = Store::open(folder, question, restart)?;
    let mut study = Study {
        conditions: conditions::open(&store)?,
        store,
        plan,
        signature,
        ledger: Ledger::new(question, notify),
        csv: table::CSV_HEADER.into(),
    };
    let scenes: Vec<SceneOutcome> =
        (0..question.scenes.len()).map(|scene| study.scene(scene, enter)).collect::<Result<_>>()?;
    let outcome = Outcome {
        made_by: question.program.clone(),
        command: signature.command.clone(),
        machine: signature.machine.clone(),
        conditions: Some(study.conditions),
        confidence: signature.confidence,
        scenes,
    };
    study.store.write_text("study.csv", &study.csv)?;
    study.store.write_json("study.json", &outcome)?;
    Ok(outcome)
}

/// Work done, in renders of a contender.
struct Ledger<'a> {
    notify: &'a mut dyn FnMut(&Progress),
    all: f64,
    done: f64,
    /// What a reference takes.
    reference: f64,
}

impl<'a> Ledger<'a> {
    fn new(question: &Question, notify: &'a mut dyn FnMut(&Progress)) -> Self {
        let renders = (question.contenders.len() as u64 * question.seeds) as f64;
        let reference = match question.reference {
            Wanted::Files(_) => 0.0,
            Wanted::Made { effort, .. } => effort
                .and_then(|effort| times(effort, question.effort))
                .unwrap_or((reference::EFFORT * question.seeds) as f64),
        };
        let all = (question.scenes.len() as f64 * (renders + reference)).max(1.0);
        Self { notify, all, done: 0.0, reference }
    }

    /// `part` of the next `work` is done.
    fn notify(&mut self, work: f64, part: f64, doing: &str, is_old: bool) {
        let share = (self.done + work * part) / self.all;
        (self.notify)(&Progress { share, doing: doing.to_owned(), is_old });
    }

    fn finish(&mut self, work: f64, doing: &str, is_old: bool) {
        self.done += work;
        self.notify(0.0, 0.0, doing, is_old);
    }
}

/// How many times `one` makes `all`, where both are of a kind.
fn times(all: Effort, one: Effort) -> Option<f64> {
    match (all, one) {
        (Effort::Samples(all), Effort::Samples(one)) => Some(all as f64 / one.max(1) as f64),
        (Effort::Seconds(all), Effort::Seconds(one)) => Some(all / one),
        _ => None,
    }
}

struct Study<'a> {
    store: Store,
    conditions: Conditions,
    plan: Plan,
    signature: &'a Signature,
    ledger: Ledger<'a>,
    csv: String,
}

/// A contender that takes part in a scene.
struct Player<'a> {
    contender: &'a Contender,
    slug: String,
    entry: &'a Entry,
    budgets: &'a [u64],
}

impl Study<'_> {
    fn scene(&mut self, index: usize, enter: &mut Enter<'_>) -> Result<SceneOutcome> {
        let question = self.plan.question.clone();
        let name = question.scenes[index].name.as_str();
        let entries = self.entries(index, &question, enter);
        let plan = self.planned(index, &question, &entries, enter)?;
        let parts = question.contenders.iter().zip(&entries).zip(&plan.contenders);
        let players: Vec<Player<'_>> = parts
            .filter_map(|((contender, entry), part)| match (entry, part) {
                (Ok(entry), Part::Budgets(budgets)) => {
                    Some(Player { contender, slug: contender.slug(), entry, budgets })
                }
                _ => None,
            })
            .collect();
        let Some(first) = players.first() else {
            let why = entries.into_iter().find_map(Result::err);
            return Err(why.unwrap_or_else(|| no_contender(name, &plan.contenders)));
        };
        let (width, height) = first.entry.size();
        let truth = self.truth(index, &question, &plan, (width, height), enter)?;
        let image = Path::new("images").join(name).join("reference.exr");
        self.store.write_image(&image, &truth.picture)?;
        self.take_turns(name, &question, &players, &truth)?;
        let refused = plan.contenders.iter().filter_map(|part| match part {
            Part::Refused(why) => Some(why.clone()),
            Part::Budgets(_) => None,
        });
        let mut notes: Vec<String> = refused.chain(truth.notes.iter().cloned()).collect();
        if truth.own_relmse.is_none() {
            notes.push("the reference's own error is not known: give it by --reference-error".to_owned());
        }
        let contenders = self.sum_up(name, &question, &players, &truth)?;
        let like = plan.reference.iter().filter_map(|part| part.like.clone()).collect();
        let Truth { how, own_relmse, known_by, apart, .. } = truth;
        let reference = Reference { image, how, own_relmse, known_by, apart, like };
        Ok(SceneOutcome { name: name.to_owned(), width, height, reference, contenders, notes })
    }

    /// Everybody who can render the scene, and why others cannot.
    fn entries(&mut self, scene: usize, question: &Question, enter: &mut Enter<'_>) -> Vec<Result<Entry>> {
        self.ledger.notify(0.0, 0.0, &format!("{}: loading", question.scenes[scene].name), true);
        question.contenders.iter().map(|contender| enter(scene, &contender.how)).collect()
    }

    /// The scene's plan; made and written down where there is none yet.
    fn planned(
        &mut self,
        scene: usize,
        question: &Question,
        entries: &[Result<Entry>],
        enter: &mut Enter<'_>,
    ) -> Result<ScenePlan> {
        if let Some(plan) = self.plan.scenes.get(scene) {
            return Ok(plan.clone());
        }
        let name = &question.scenes[scene].name;
        let mut contenders = Vec::new();
        for (contender, entry) in question.contenders.iter().zip(entries) {
            self.ledger.notify(0.0, 0.0, &format!("{name}: {}, pilot", contender.name), true);
            let samples = |entry: &Entry| plan::samples(entry, question.effort, question.first_seed);
            let exact = matches!(question.effort, Effort::Samples(_));
            contenders.push(match entry.as_ref().map_err(Error::clone).and_then(samples) {
                Err(why) => Part::Refused(refused(&contender.name, &why)),
                Ok(largest) => Part::Budgets(plan::budgets(largest, question.doublings, exact)),
            });
        }
        self.ledger.notify(0.0, 0.0, &format!("{name}: reference, pilot"), true);
        let reference = match &question.reference {
            Wanted::Files(_) => Vec::new(),
            Wanted::Made { others, is_given, effort } => {
                let able: Vec<Option<&Entry>> = entries
                    .iter()
                    .zip(&contenders)
                    .map(|(entry, part)| entry.as_ref().ok().filter(|_| matches!(part, Part::Budgets(_))))
                    .collect();
                reference::plan(question, scene, (others, *is_given, *effort), &able, enter)?
            }
        };
        let planned = ScenePlan { contenders, reference };
        self.plan.scenes.push(planned.clone());
        self.store.write_plan(&self.plan)?;
        Ok(planned)
    }

    fn truth(
        &mut self,
        scene: usize,
        question: &Question,
        plan: &ScenePlan,
        (width, height): (usize, usize),
        enter: &mut Enter<'_>,
    ) -> Result<Truth> {
        if let Wanted::Files(files) = &question.reference {
            return reference::read(&files[scene], width, height);
        }
        let name = &question.scenes[scene].name;
        let (work, doing) = (self.ledger.reference, format!("{name}: reference"));
        let ledger = &mut self.ledger;
        let entry = &mut |how: &How| enter(scene, how);
        let notify = &mut |share: f64, is_old: bool| ledger.notify(work, share, &doing, is_old);
        let truth = reference::make(&self.store, name, &plan.reference, question.first_seed, entry, notify);
        self.ledger.finish(work, &doing, false);
        truth
    }

    /// Seed by seed, everybody renders once: what the machine does besides falls on all alike.
    fn take_turns(
        &mut self,
        scene: &str,
        question: &Question,
        players: &[Player<'_>],
        truth: &Truth,
    ) -> Result<()> {
        for (number, seed) in seeds(question).enumerate() {
            for Player { contender, slug, entry, budgets } in players {
                let doing = format!("{scene}: {}, seed {} of {}", contender.name, number + 1, question.seeds);
                let slot = Slot { scene, contender: slug, seed };
                let is_old = self.store.has(slot.numbers());
                if !is_old {
                    let ledger = &mut self.ledger;
                    let notify = &mut |share: f64| ledger.notify(1.0, share, &doing, false);
                    unit::run(&self.store, slot, entry, budgets, &truth.picture, number == 0, notify)?;
                    conditions::note(&self.store, &mut self.conditions)?;
                }
                self.ledger.finish(1.0, &doing, is_old);
            }
        }
        let absent = question.contenders.len() - players.len();
        self.ledger.finish((absent as u64 * question.seeds) as f64, scene, true);
        Ok(())
    }

    fn sum_up(
        &mut self,
        scene: &str,
        question: &Question,
        players: &[Player<'_>],
        truth: &Truth,
    ) -> Result<Vec<ContenderOutcome>> {
        let mut first: Option<Vec<Unit>> = None;
        let mut outcomes = Vec::new();
        for Player { contender, slug, entry, .. } in players {
            let slot = |seed| Slot { scene, contender: slug, seed };
            let unit = |seed| self.store.read_json(slot(seed).numbers(), LOST_UNIT);
            let units: Vec<Unit> = seeds(question).map(unit).collect::<Result<_>>()?;
            let turns = Turns { name: &contender.name, first: slot(question.first_seed), units: &units };
            let mut notes = entry.notes.clone();
            if let Some((scene, options)) = entry.estimator() {
                notes.extend(coverage::notes(scene, options));
            }
            let confidence = self.signature.confidence;
            outcomes.push(summary::contender(&turns, first.as_deref(), truth, notes, confidence));
            let images = seeds(question).map(|seed| self.store.read_image(slot(seed).last_image()));
            let variance = variance(&images.collect::<Result<Vec<_>>>()?);
            self.store.write_image(summary::variance_image(scene, slug), &variance)?;
            self.csv += &table::csv_rows(scene, &contender.name, &units);
            first.get_or_insert(units);
        }
        Ok(outcomes)
    }
}

/// For a render that reported unreadable numbers.
const LOST_UNIT: &str = "remove the file to render it again, or restart the whole study with --restart";

fn seeds(question: &Question) -> impl Iterator<Item = u64> {
    let first = question.first_seed;
    (0..question.seeds).map(move |seed| first.wrapping_add(seed))
}

/// Variance over independent images, pixel by pixel.
fn variance(images: &[Picture]) -> Picture {
    let of = |pixel: usize| {
        reference::moments(images.iter().map(|image| image.pixels[pixel].as_dvec3())).1.as_vec3()
    };
    Picture { pixels: (0..images[0].pixels.len()).map(of).collect(), ..images[0] }
}

/// Why somebody cannot render a scene, in one line.
fn refused(name: &str, Error { place, expected, found, .. }: &Error) -> String {
    format!("{name} cannot render it: {place}: expected {expected}, found {found}")
}

fn no_contender(scene: &str, parts: &[Part]) -> Error {
    let why = parts.iter().find_map(|part| match part {
        Part::Refused(why) => Some(why.clone()),
        Part::Budgets(_) => None,
    });
    let remedy = "name others by --contender, --external or --vary";
    Error::new(scene, "a contender that can render the scene", why.unwrap_or_else(|| "none".into()), remedy)
}
