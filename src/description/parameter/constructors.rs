//! The rows of tables: a constructor for each kind of parameter.

use super::*;

/// A number.
pub const fn number(
    name: &'static str,
    unit: &'static str,
    range: Range,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Number(range), default, about).unit(unit)
}

/// A number that f32 holds, >= 0.
pub const fn factor(name: &'static str, default: f64, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Number(within(0.0, MAX)), Is(default), about)
}

/// An index of refraction: a number or the name of a material.
pub const fn number_or_name(
    name: &'static str,
    range: Range,
    default: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::NumberOrName(range), Word(default), about)
}

/// A whole number.
pub const fn integer(name: &'static str, range: Range, default: Default, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Integer(range), default, about)
}

/// `true` or `false`.
pub const fn boolean(name: &'static str, default: bool, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Boolean, Default::Yes(default), about)
}

/// Text, which is `what`.
pub const fn text(
    name: &'static str,
    what: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Text(what), default, about)
}

/// One of a few words.
pub const fn choice(
    name: &'static str,
    words: &'static [&'static str],
    default: &'static str,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Choice(words), Word(default), about)
}

/// A point or vector.
pub const fn vector(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Vector, default, about).unit(unit)
}

/// One number for all channels or three, which must be given.
pub const fn channels(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Channels, Required, about)
}

/// A transform, the identity where not given.
pub const fn transform(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Transform, Said("identity"), about)
}

/// A colour of matter.
pub const fn colour(
    name: &'static str,
    unit: &'static str,
    most: f64,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Colour(Role::Matter, most), default, about).unit(unit)
}

/// A colour of light.
pub const fn light(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Colour(Role::Light, f64::INFINITY), default, about).unit(unit)
}

/// A colour or texture of matter.
pub const fn texture(name: &'static str, most: f64, default: Default, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Matter, most), default, about)
}

/// A colour or texture of indices of refraction.
pub const fn index_texture(name: &'static str, most: f64, default: f64, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Index, most), Is(default), about)
}

/// A colour or texture of light.
pub const fn light_texture(
    name: &'static str,
    unit: &'static str,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Texture(Role::Light, f64::INFINITY), default, about).unit(unit)
}

/// A colour of matter, or a volume.
pub const fn volume(
    name: &'static str,
    unit: &'static str,
    most: f64,
    default: Default,
    about: &'static str,
) -> Parameter {
    Parameter::new(name, Kind::Volume(Role::Matter, most), default, about).unit(unit)
}

/// A colour of light, or a volume.
pub const fn light_volume(name: &'static str, unit: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Volume(Role::Light, f64::INFINITY), Optional, about).unit(unit)
}

/// A spectrum of wavelengths and values.
pub const fn spectrum(name: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Spectrum, Optional, about)
}

/// The name of a file, which must be given. `name` ends with `filename`, by which it is known what a scene reads.
pub const fn file(name: &'static str, about: &'static str) -> Parameter {
    assert!(matches!(name.as_bytes(), [.., b'f', b'i', b'l', b'e', b'n', b'a', b'm', b'e']));
    Parameter::new(name, Kind::File, Required, about)
}

/// A plugin of the kind `tag`.
pub const fn object(name: &'static str, tag: &'static str, about: &'static str) -> Parameter {
    Parameter::new(name, Kind::Object(tag), Optional, about)
}

/// Plugins of the kind `tag`, under any name.
pub const fn nested(tag: &'static str, default: Default, about: &'static str) -> Parameter {
    Parameter::new(tag, Kind::Nested, default, about)
}

/// A parameter that is accepted with a warning that it is not used, and why.
pub const fn ignored(name: &'static str, why: &'static str) -> Parameter {
    Parameter::new(name, Kind::Ignored { silent: false }, Optional, why)
}

/// A parameter that is accepted and cannot change what is rendered.
pub const fn silent(name: &'static str, why: &'static str) -> Parameter {
    Parameter::new(name, Kind::Ignored { silent: true }, Optional, why)
}

/// The words of a list of words with their meanings.
pub const fn words<const COUNT: usize, T>(meanings: &[(&'static str, T)]) -> [&'static str; COUNT] {
    let mut words = [""; COUNT];
    let mut index = 0;
    while index < COUNT {
        words[index] = meanings[index].0;
        index += 1;
    }
    words
}
