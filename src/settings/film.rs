//! The film as a scene describes it: Mitsuba's `hdrfilm`.

use crate::{
    description::{Library, Object, Params, Plugin, Registry, Table, params::Child, substitutes, table},
    error::{Error, Result},
    film::{
        Film, Window,
        filter::{self, Filter},
        format::{COMPONENT_FORMATS, FILE_FORMATS, Format, PIXEL_FORMATS},
    },
    settings::{Crop, Overrides, only_one},
};

/// The size of a film that says nothing (pixels).
const DEFAULT_SIZE: [u32; 2] = [768, 576];
/// A larger image would take more than 10 GB while it is rendered.
const MOST_PIXELS: u64 = 1 << 28;
const DEFAULT_FILTER: Filter = Filter::Gaussian { stddev: 0.5 };

/// The film.
pub(crate) const ROWS: Registry<Plugin<()>> =
    Registry::new("a film", &[("hdrfilm", Plugin { table: TABLE, build: () })]);

const TABLE: Table = table! {
    "The image: its size, format and reconstruction filter.";
    integer("width", within(1.0, MOST), Is(DEFAULT_SIZE[0] as f64), "Pixels across."),
    integer("height", within(1.0, MOST), Is(DEFAULT_SIZE[1] as f64), "Pixels down."),
    integer("crop_offset_x", within(0.0, MOST), Is(0.0), "Columns to the left of the crop window."),
    integer("crop_offset_y", within(0.0, MOST), Is(0.0), "Rows above the crop window."),
    integer("crop_width", within(1.0, MOST), Said("`width`"), "Columns of the crop window."),
    integer("crop_height", within(1.0, MOST), Said("`height`"), "Rows of the crop window."),
    choice("pixel_format", &words::<6, _>(PIXEL_FORMATS), "rgb", "Channels of the image."),
    choice("component_format", &words::<3, _>(COMPONENT_FORMATS), "float32", "Number format of the channels."),
    choice("file_format", &words::<4, _>(FILE_FORMATS), "openexr", "File format."),
    boolean("sample_border", false, "True: samples also lie outside the border, as far as the filter reaches."),
    nested("rfilter", Optional, "The reconstruction filter; default: a `gaussian`."),
    ignored("banner", "Mitsuba 3 does not use it either"),
    ignored("compensate", "Mitsuba 3 does not use it either"),
};

/// Most pixels along a side.
const MOST: f64 = 65536.0;

/// True if `child` is meant to be a film.
pub fn is_film(child: &Child<'_>) -> bool {
    let plugin = child.object.plugin.as_str();
    child.object.tag.as_deref() == Some("film") || child.name == "film" || plugin == "hdrfilm"
}

/// The film of a sensor that has none.
pub fn default(overrides: Overrides) -> Film {
    let [width, height] = overrides.size.map_or(DEFAULT_SIZE, |(width, height)| [width, height]);
    Film::new(Window::whole(width, height), DEFAULT_FILTER, false, Format::default())
}

/// Builds the film that `object` describes.
pub fn build(object: &Object, library: &Library, overrides: Overrides) -> Result<Film> {
    if object.plugin != "hdrfilm" {
        let remedy = substitutes::of_plugin(&object.plugin, Some("film")).unwrap_or("use \"hdrfilm\"");
        let found = format!("\"{}\"", object.plugin);
        return Err(Error::new(&object.location, "the film \"hdrfilm\"", found, remedy));
    }
    let params = Params::new(object, library, &TABLE);
    let window = window(&params, overrides)?;
    let filter = rfilter(&params)?;
    let sample_border = params.boolean("sample_border")?;
    let format = format(&params)?;
    params.finish()?;
    Ok(Film::new(window, filter, sample_border, format))
}

fn window(params: &Params<'_>, overrides: Overrides) -> Result<Window> {
    let pixels = |name| params.integer(name).map(|pixels| pixels as u32);
    let full_size = [pixels("width")?, pixels("height")?];
    let offset = [pixels("crop_offset_x")?, pixels("crop_offset_y")?];
    let part = |name, whole| Ok(params.optional_integer(name)?.map_or(whole, |pixels| pixels as u32));
    let crop = [part("crop_width", full_size[0])?, part("crop_height", full_size[1])?];
    for (axis, names) in
        [["crop_offset_x", "crop_width"], ["crop_offset_y", "crop_height"]].iter().enumerate()
    {
        if offset[axis] + crop[axis] > full_size[axis] {
            let name = names.iter().find(|name| params.has(name)).unwrap_or(&names[0]);
            let found = format!("{} and {} pixels from there", offset[axis], crop[axis]);
            let expected = format!("a crop window inside the film's {} pixels", full_size[axis]);
            return Err(params.complain(name, expected, found));
        }
    }
    let window = Window { full_size, offset, size: crop };
    let [across, down] = overrides.size.map_or(crop, |(width, height)| [width, height]).map(u64::from);
    if across * down > MOST_PIXELS {
        let found = format!("{across} x {down}");
        let remedy = "render it in several crop windows, or smaller";
        return Err(Error::new(
            params.location(),
            format!("an image of at most {MOST_PIXELS} pixels"),
            found,
            remedy,
        ));
    }
    match overrides.size {
        None => Ok(window),
        Some((width, height)) if window.is_whole() => Ok(Window::whole(width, height)),
        Some(_) => Err(Error::new(
            "--size",
            "a film without a crop window",
            format!("a window of {} x {} pixels of the film at {}", crop[0], crop[1], params.location()),
            "leave --size out, or remove the crop window from the scene",
        )),
    }
}

/// The film of `sensor`, which measures one number: one pixel, whose samples all count alike. The size of `film` may be
/// `given`.
pub fn of_one_pixel(film: &Film, sensor: &Object, given: bool) -> Result<Film> {
    let [width, height] = film.window.full_size;
    if given && [width, height] != [1, 1] {
        let expected = format!("a film of one pixel for the {}", sensor.plugin);
        let remedy = "set \"width\" and \"height\" of its film to 1, and leave out --size";
        return Err(Error::new(&sensor.location, expected, format!("{width} x {height} pixels"), remedy));
    }
    Ok(Film::new(Window::whole(1, 1), Filter::Box, false, film.format))
}

/// The part of `film` that is to be rendered.
pub fn cropped(film: Film, crop: Option<Crop>) -> Result<Film> {
    let Some(crop) = crop else { return Ok(film) };
    let [width, height] = film.window.size;
    let end = |axis: usize| crop.corner[axis].checked_add(crop.size[axis]);
    if (0..2).any(|axis| end(axis).is_none_or(|end| end > film.window.size[axis])) {
        return Err(Error::new(
            "--crop",
            format!("a part of the image of {width} x {height} pixels"),
            crop.to_string(),
            "choose WIDTHxHEIGHT+X+Y so that it ends inside",
        ));
    }
    Ok(film.part(crop.corner, crop.size))
}

fn rfilter(params: &Params<'_>) -> Result<Filter> {
    let is_filter = |child: &Child<'_>| {
        child.name == "rfilter"
            || child.object.tag.as_deref() == Some("rfilter")
            || filter::ROWS.has(child.object)
    };
    match params.children("rfilter", is_filter)?.as_slice() {
        [] => Ok(DEFAULT_FILTER),
        [one] => filter::ROWS.build(one.object, params.library),
        [_, second, ..] => Err(only_one(second, "rfilter")),
    }
}

fn format(params: &Params<'_>) -> Result<Format> {
    let (colours, alpha) = params.choice("pixel_format", PIXEL_FORMATS)?;
    let component = params.choice("component_format", COMPONENT_FORMATS)?;
    let file = params.choice("file_format", FILE_FORMATS)?;
    let requested = Format { colours, alpha, component, file };
    let format = requested.in_file(file);
    if params.has("pixel_format") && (format.colours, format.alpha) != (colours, alpha)
        || params.has("component_format") && format.component != component
    {
        let text = format!("this file_format holds {}; {} is written", file.holds(), format.names().concat());
        params.library.warn(params.location(), &text);
    }
    Ok(format)
}
