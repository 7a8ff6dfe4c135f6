//! `batch`: before anything is built, it is replaced by the sensors in it, each with its part of the film.

use crate::{
    description::{Library, Object, Params, Property, Value, params::Child},
    error::{Error, Result},
    sensor::{self, BATCH, BATCH_TABLE},
    settings::{film, only_one, sampler},
};
use std::borrow::Cow;

/// `root` with the sensors of a `batch` in its place.
pub(super) fn expand(root: &Object) -> Result<Cow<'_, Object>> {
    if !root.properties.iter().any(|property| batch_in(property).is_some()) {
        return Ok(Cow::Borrowed(root));
    }
    let library = Library::new(root)?;
    let mut properties = Vec::with_capacity(root.properties.len());
    for property in &root.properties {
        match batch_in(property) {
            Some(batch) => properties.extend(sensors(batch, &library)?),
            None => properties.push(property.clone()),
        }
    }
    Ok(Cow::Owned(Object { properties, ..root.clone() }))
}

fn batch_in(property: &Property) -> Option<&Object> {
    if let Value::Object(child) = &property.value {
        Some(child).filter(|child| child.plugin == BATCH)
    } else {
        None
    }
}

/// The sensors of `batch`, each with the film and the sampler that are its own here.
fn sensors(batch: &Object, library: &Library) -> Result<Vec<Property>> {
    let params = Params::new(batch, library, &BATCH_TABLE);
    let sensors = params.children("sensor", |child| sensor::ROWS.has(child.object))?;
    let films = params.children("film", film::is_film)?;
    let samplers = params.children("sampler", |child| sampler::ROWS.has(child.object))?;
    params.finish()?;
    if sensors.is_empty() {
        let remedy = "put one or more sensors into it";
        return Err(Error::new(&batch.location, "sensors in the batch", "none", remedy));
    }
    let seconds = [("film", &films), ("sampler", &samplers)];
    if let Some((what, second)) = seconds.iter().find_map(|(what, found)| Some((what, found.get(1)?))) {
        return Err(only_one(second, what));
    }
    let film = part_of(films.first(), batch, library, sensors.len() as i64)?;
    let shared: Vec<Property> = std::iter::once(property("film", film, batch))
        .chain(samplers.first().map(|child| property("sampler", child.object.clone(), batch)))
        .collect();
    let own = |given: &&Property| {
        let child = match &given.value {
            Value::Object(child) => Some(child),
            Value::Reference(id) => library.find(id),
            _ => None,
        };
        child.is_none_or(|child| !(child.plugin.ends_with("film") || sampler::ROWS.has(child)))
    };
    let with_film = |child: &Child<'_>| {
        let kept = child.object.properties.iter().filter(own).cloned();
        let name = Some(child.name).filter(|name| !name.is_empty() && library.find(name).is_none());
        let id = child.object.id.clone().or(name.map(str::to_owned));
        let object = Object { id, properties: kept.chain(shared.clone()).collect(), ..child.object.clone() };
        property(child.name, object, batch)
    };
    Ok(sensors.iter().map(with_film).collect())
}

fn property(name: &str, object: Object, batch: &Object) -> Property {
    Property { name: name.into(), value: Value::Object(object), location: batch.location.clone() }
}

/// The `count`-th part of the width of the batch's film.
fn part_of(film: Option<&Child<'_>>, batch: &Object, library: &Library, count: i64) -> Result<Object> {
    let default = || Object {
        tag: Some("film".into()),
        plugin: "hdrfilm".into(),
        id: None,
        properties: vec![],
        location: batch.location.clone(),
    };
    let mut film = film.map_or_else(default, |child| child.object.clone());
    let is_known = film::ROWS.has(&film);
    // The film itself says what is wrong with another one.
    let width = if is_known { film::ROWS.read(&film, library)?.0.integer("width")? } else { count };
    if width % count != 0 {
        let expected = format!("a width that {count} sensors can share");
        let remedy = format!("set the film's \"width\" to {}", (width / count).max(1) * count);
        return Err(Error::new(&film.location, expected, width.to_string(), remedy));
    }
    film.id = None;
    if is_known {
        let place = film.properties.iter().find(|property| property.name == "width");
        let location = place.map_or(&film.location, |width| &width.location).clone();
        film.properties.retain(|property| property.name != "width");
        let value = Value::Integer(width / count);
        film.properties.push(Property { name: "width".into(), value, location });
    }
    Ok(film)
}
