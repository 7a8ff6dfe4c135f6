//! What textures require of their surfaces beyond texture coordinates, and whether surfaces have it.

use crate::{
    bsdf,
    description::{Library, Location, Object, Table, Value},
    error::{Error, Result},
    shape::Shape,
    texture,
};

/// What the textures of a description require.
#[derive(Default)]
pub(super) struct Asked<'a> {
    attributes: Vec<Wanted<'a>>,
    /// A texture that requires the position or the parametrisation.
    place: Option<&'a Location>,
}

/// Colours of a mesh.
struct Wanted<'a> {
    name: &'a str,
    location: &'a Location,
    scale: f64,
    /// Their upper limit, scaled.
    most: f64,
}

/// The table of a plugin that may have textures.
fn table(object: &Object) -> Option<&'static Table> {
    let of_texture = || texture::ROWS.get(&object.plugin).map(|plugin| &plugin.table);
    bsdf::ROWS.get(&object.plugin).map(|plugin| &plugin.table).or_else(of_texture)
}

impl<'a> Asked<'a> {
    /// Of `object`, which builds, and of all its parts.
    pub(super) fn by(object: &'a Object, library: &'a Library) -> Self {
        let mut asked = Self::default();
        asked.walk(object, library, f64::INFINITY);
        asked
    }

    fn walk(&mut self, object: &'a Object, library: &'a Library, most: f64) {
        match object.plugin.as_str() {
            "mesh_attribute" => return self.attribute(object, most),
            "volume" => self.place = Some(&object.location),
            "bumpmap" => self.place = Some(&object.location),
            _ => {}
        }
        for property in &object.properties {
            let child = match &property.value {
                Value::Object(child) => Some(child),
                Value::Reference(id) => library.find(id),
                _ => None,
            };
            let row = table(object).and_then(|table| table.find(&property.name));
            let limit = row.map_or(f64::INFINITY, |row| row.range().high);
            if let Some(child) = child.filter(|child| table(child).is_some()) {
                self.walk(child, library, most.min(limit));
            }
        }
    }

    fn attribute(&mut self, object: &'a Object, most: f64) {
        let name = object.properties.iter().find_map(|property| match &property.value {
            Value::String(name) if property.name == "name" => Some(name.as_str()),
            _ => None,
        });
        let scale = object.number("scale").unwrap_or(1.0);
        self.attributes.extend(name.map(|name| Wanted { name, location: &object.location, scale, most }));
    }

    /// True if it asks for anything.
    pub(super) fn is_any(&self) -> bool {
        self.place.is_some() || !self.attributes.is_empty()
    }

    /// An error unless `shape`, called `name`, has these colours, with values in range.
    pub(super) fn check(&self, shape: &Shape, name: &str) -> Result<()> {
        self.attributes.iter().try_for_each(|wanted| wanted.check(shape, name))
    }

    /// Emitters provide none of it: an error if anything is required.
    pub(super) fn refuse(&self) -> Result<()> {
        let Some(location) = self.place.or(self.attributes.first().map(|wanted| wanted.location)) else {
            return Ok(());
        };
        let found = "one that depends on where the surface is";
        let remedy = "use an image, by texture coordinates";
        Err(Error::new(location, "a bitmap or checkerboard on an emitter", found, remedy))
    }
}

impl Wanted<'_> {
    fn check(&self, shape: &Shape, owner: &str) -> Result<()> {
        let Self { name, location, scale, most } = *self;
        let Some(attribute) = shape.attributes().iter().find(|attribute| attribute.name == name) else {
            let known: Vec<_> = shape.attributes().iter().map(|a| format!("\"{}\"", a.name)).collect();
            let expected = format!("an attribute that \"{owner}\" has");
            let remedy = if known.is_empty() {
                "use a PLY mesh with colours, or another texture".into()
            } else {
                format!("name one that it has: {}", known.join(", "))
            };
            return Err(Error::new(location, expected, format!("\"{name}\""), remedy));
        };
        let channels = || attribute.values.iter().flat_map(|value| value.to_array());
        let [low, high] = channels().fold([0f32, 0.0], |[low, high], x| [low.min(x), high.max(x)]);
        let reached = [low, high].map(|x| f64::from(x) * scale);
        if reached[0] >= 0.0 && reached[1] <= most {
            return Ok(());
        }
        let found = format!("\"{name}\" of \"{owner}\", from {} to {}", reached[0], reached[1]);
        let expected =
            if most < f64::MAX { format!("values from 0 to {most}") } else { "values >= 0".into() };
        let remedy = "give the texture a \"scale\" (1/255 makes bytes colours), or correct the mesh";
        Err(Error::new(location, expected, found, remedy))
    }
}
