//! Nested sensors move up to the scene before anything is built. Those of a `batch` each take a part of its film; those
//! on a shape get a reference to it.

use crate::{
    description::{Library, Object, Params, Property, Value, params::Child},
    error::{Error, Result},
    sensor::{self, BATCH, BATCH_TABLE, ON_SHAPE},
    settings::{film, only_one, sampler},
    shape,
};
use std::borrow::Cow;

/// `root` with its sensors beside each other.
pub(super) fn expand(root: &Object) -> Result<Cow<'_, Object>> {
    let is_around = |child: &&Object| child.plugin == BATCH || has_meter(child);
    let around = |property| object_in(property).filter(is_around);
    if !root.properties.iter().any(|property| around(property).is_some()) {
        return Ok(Cow::Borrowed(root));
    }
    let library = Library::new(root)?;
    let mut properties = Vec::with_capacity(root.properties.len());
    for property in &root.properties {
        match around(property) {
            Some(batch) if batch.plugin == BATCH => properties.extend(sensors(batch, &library)?),
            Some(shape) => properties.extend(taken_off(shape, property, &library)?),
            None => properties.push(property.clone()),
        }
    }
    Ok(Cow::Owned(Object { properties, ..root.clone() }))
}

fn object_in(property: &Property) -> Option<&Object> {
    if let Value::Object(child) = &property.value { Some(child) } else { None }
}

/// True of a shape on which something is measured.
fn has_meter(object: &Object) -> bool {
    let mut children = object.properties.iter().filter_map(object_in);
    shape::ROWS.has(object) && children.any(|child| child.plugin == ON_SHAPE)
}

/// `shape`, the value of `given`, without its sensors; then these sensors.
fn taken_off(shape: &Object, given: &Property, library: &Library) -> Result<Vec<Property>> {
    let (params, _) = shape::ROWS.read(shape, library)?;
    let on = |child: &Child<'_>| child.object.plugin == ON_SHAPE;
    let sensors = params.children("sensor", on)?;
    let id = shape.id.clone().unwrap_or_else(|| format!("{} at {}", shape.plugin, shape.location));
    let mut bare = Object { id: Some(id.clone()), ..shape.clone() };
    bare.properties.retain(|property| object_in(property).is_none_or(|child| child.plugin != ON_SHAPE));
    let of = |child: &Child<'_>| {
        let location = child.location.clone();
        let mut sensor = child.object.clone();
        sensor.properties.push(Property {
            name: "shape".into(),
            value: Value::Reference(id.clone()),
            location,
        });
        property(child.name, named(child, sensor, library), shape)
    };
    let sensors = sensors.iter().map(of);
    Ok(std::iter::once(Property { value: Value::Object(bare), ..given.clone() }).chain(sensors).collect())
}

/// `sensor`, made of `child`, with an id to choose it by.
fn named(child: &Child<'_>, sensor: Object, library: &Library) -> Object {
    let name = Some(child.name).filter(|name| !name.is_empty() && library.find(name).is_none());
    let id = sensor.id.clone().or(name.map(str::to_owned));
    Object { id, ..sensor }
}

/// The sensors of `batch`, each with its part of the film, and the sampler of the batch.
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
    let with_film = |child: &Child<'_>| {
        let kept = child.object.properties.iter().filter(|given| !is_of_batch(given, library)).cloned();
        let object = Object { properties: kept.chain(shared.clone()).collect(), ..child.object.clone() };
        property(child.name, named(child, object, library), batch)
    };
    Ok(sensors.iter().map(with_film).collect())
}

/// True for a film or a sampler: cameras in a batch take those of the batch.
fn is_of_batch(given: &Property, library: &Library) -> bool {
    let child = match &given.value {
        Value::Object(child) => Some(child),
        Value::Reference(id) => library.find(id),
        _ => None,
    };
    child.is_some_and(|child| child.plugin.ends_with("film") || sampler::ROWS.has(child))
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
