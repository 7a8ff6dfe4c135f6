//! A shape with its surface, boundary and emitter.

use super::{Builder, Placed, asked::Asked, groups::Copying, name_of};
use crate::{
    bsdf::{self, Bsdf, BsdfModel},
    description::{Location, Params, params::Child},
    emitter,
    error::{Error, Result},
    math::{DAffine3, DMat4},
    medium::MediumIndex,
    scene::{
        Surface,
        contact::{Nature, Rank},
        media::Boundary,
    },
    sensor::ON_SHAPE,
    settings::only_one,
    shape::{self, Shape, ShapeModel as _},
};

impl<'a> Builder<'a> {
    /// From the file's coordinates to the scene's.
    pub(super) fn world(&self) -> DMat4 {
        DMat4::from_translation(-self.recentre)
    }

    /// One shape, where it stands or `at` an instance of its group.
    pub(super) fn plain(&mut self, child: &Child<'a>, at: Option<Copying<'a>>) -> Result<()> {
        let (params, build) = shape::ROWS.read(child.object, self.library)?;
        let before = self.before.filter(|_| at.is_none());
        let old = before.and_then(|before| before.shape(child.object, self.recentre)).cloned();
        let is_old = old.is_some();
        let (shape, is_read) = match (old, at) {
            (Some(old), _) => (old, false),
            (None, None) => (build(&params, self.world())?, true),
            (None, Some(at)) => self.copied(&params, *build, at)?,
        };
        self.place.instance = at.map_or(DAffine3::IDENTITY, |at| at.of_volumes());
        let interior = self.side(&params, "interior")?;
        let exterior = self.side(&params, "exterior")?;
        let emitter = self.shape_emitter(&params, self.shapes.len() as u32)?;
        self.place.instance = DAffine3::IDENTITY;
        let bsdfs = params.children("bsdf", |child| bsdf::ROWS.has(child.object))?;
        let (bsdf, asked) = match bsdfs.as_slice() {
            [] => (self.default_bsdf(emitter.is_some())?, Asked::default()),
            [one] => (self.bsdf(one.object)?, Asked::by(one.object, self.library)),
            [_, second, ..] => return Err(only_one(second, "bsdf")),
        };
        let sensors = params.children("sensor", |child| child.object.plugin == ON_SHAPE)?;
        if let Some(sensor) = sensors.first() {
            let expected = "an irradiancemeter inside a shape that stands in the scene itself";
            let found = "one in a group of shapes, or a reference to one";
            return Err(Error::new(sensor.location, expected, found, "move it into such a shape"));
        }
        // The parameters of a reused shape were read before.
        if is_read {
            params.finish()?;
        }
        // Instances of a shared shape have the attributes of the first one.
        if is_read || is_old {
            asked.check(&shape, &name_of(child.object))?;
        }
        self.has_old_shapes &= is_old;
        if at.is_none() {
            self.parts.shapes.insert(child.object.location.clone(), self.shapes.len());
        }
        self.shapes.push(shape);
        self.shape_names.push(name_of(child.object));
        self.shape_locations.push(child.location.clone());
        let model = &self.bsdfs[bsdf as usize];
        let nature = nature(model, bsdf, emitter.is_some());
        let (connectible, transmits) = (model.is_connectible(), model.transmits());
        let boundary = Boundary::stated(interior, exterior, transmits);
        if transmits && boundary.is_known() {
            self.mend_container(exterior.is_some(), child.location);
        }
        self.natures.push(nature);
        let detailed = asked.is_any();
        self.surfaces.push(Surface { bsdf, emitter, boundary, transmits, connectible, detailed });
        Ok(())
    }

    /// The last shape bounds a medium: if it is a mesh, all its triangles must agree on which side is which.
    fn mend_container(&mut self, is_exterior_stated: bool, location: &Location) {
        let (Some(Shape::Mesh(mesh)), Some(name)) = (self.shapes.last_mut(), self.shape_names.last()) else {
            return;
        };
        if let Some((mended, turned)) = mesh.oriented() {
            let text = format!(
                "{turned} of the {} triangles of \"{name}\" face the other way than their neighbours. They are turned \
                 over, because the boundary of a medium has one inside. Recalculate the normals in the program that \
                 made the mesh",
                mesh.primitive_count()
            );
            self.library.warn(location, &text);
            *mesh = mended;
        }
        if !is_exterior_stated && mesh.is_inside_out() {
            let text = format!(
                "\"{name}\" is inside out: its normals point into the mesh, so that its interior medium fills all the \
                 space around it. Change \"flip_normals\", or turn the mesh over in the program that made it"
            );
            self.library.warn(location, &text);
        }
    }

    /// The medium that the file states on one side of a shape.
    fn side(&mut self, params: &Params<'a>, name: &'static str) -> Result<Option<MediumIndex>> {
        params.child(name)?.map(|child| self.medium(child.object)).transpose()
    }

    fn shape_emitter(&mut self, params: &Params<'a>, shape: u32) -> Result<Option<u32>> {
        let emitters = params.children("emitter", |child| emitter::ROWS.has(child.object))?;
        let child = match emitters.as_slice() {
            [] => return Ok(None),
            [one] => one,
            [_, second, ..] => return Err(only_one(second, "emitter")),
        };
        let emitter = self.built_emitter(child.object)?;
        if !emitter.needs_shape() {
            let found = format!("\"{}\"", child.object.plugin);
            let remedy = "put it beside the shapes, in the scene itself";
            return Err(Error::new(child.location, "an area emitter on a shape", found, remedy));
        }
        let stated = self.stated_medium(&emitter::ROWS.read(child.object, self.library)?.0)?;
        self.emitters.push(Placed { emitter, shape: Some(shape), stated, location: child.location });
        Ok(Some(self.emitters.len() as u32 - 1))
    }
}

/// What contact needs to know of a shape with this BSDF.
fn nature(model: &Bsdf, bsdf: u32, emits: bool) -> Nature {
    let rank = match model {
        Bsdf::Null(_) => Rank::Null,
        model if model.transmits() => Rank::Transmitting,
        _ if emits => Rank::Emitting,
        _ => Rank::Opaque,
    };
    Nature { rank, bsdf, one_sided: !matches!(model, Bsdf::TwoSided(_)), is_lid: false }
}
