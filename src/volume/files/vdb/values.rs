//! The values of one of OpenVDB's nodes: packed, and without those that follow from a few others.

use super::super::{
    Problem, Result, blosc, inflate,
    input::Input,
    sparse::is_set,
    value::{Format, Value},
};
use std::io::{Read, Seek};

/// Flags of how a grid's values are packed.
const ZIP: u32 = 1;
const ACTIVE_ONLY: u32 = 2;
const BLOSC: u32 = 4;

/// How a grid's values are written.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coding {
    packing: u32,
    /// Of single values: the background, tiles at the root, inactive values.
    pub whole: Format,
    /// Of the values of nodes.
    stored: Format,
}

impl Coding {
    /// From the grid's flags, and whether its numbers are saved as half.
    pub(super) fn new(packing: u32, half: bool, whole: Format) -> Result<Self> {
        if packing & !(ZIP | ACTIVE_ONLY | BLOSC) != 0 {
            return Err(Problem::damage("known flags of compression", format!("{packing:#x}")));
        }
        Ok(Self { packing, whole, stored: if half { Format::Half } else { whole } })
    }
}

/// Buffers that are used again from node to node.
#[derive(Default)]
pub(super) struct Scratch {
    packed: Vec<u8>,
    plain: Vec<u8>,
}

/// Which inactive values a node leaves out, by number in the file.
#[derive(Clone, Copy)]
struct Omission<V> {
    /// All values are there.
    none: bool,
    /// Values of voxels that are not in the selection, and of those that are.
    values: [V; 2],
    selects: bool,
}

/// Reads a single value.
pub(super) fn single<V: Value, R: Read + Seek>(input: &mut Input<R>, coding: Coding) -> Result<V> {
    let mut bytes = [0; 24];
    let bytes = &mut bytes[..V::CHANNELS * coding.whole.size()];
    input.fill(bytes)?;
    Ok(coding.whole.value(bytes, 0))
}

/// Reads the values of a node, those that are active marked in `mask`, into `out`: one for every bit.
pub(super) fn read<V: Value, R: Read + Seek>(
    input: &mut Input<R>,
    coding: Coding,
    background: V,
    mask: &[u8],
    scratch: &mut Scratch,
    out: &mut Vec<V>,
) -> Result<()> {
    let omission = omission(input, coding, background)?;
    let mut selection = vec![0; if omission.selects { mask.len() } else { 0 }];
    input.fill(&mut selection)?;
    let all = 8 * mask.len();
    let reduced = coding.packing & ACTIVE_ONLY != 0 && !omission.none;
    let count = if reduced { mask.iter().map(|byte| byte.count_ones() as usize).sum() } else { all };
    unpack(input, coding, count * V::CHANNELS * coding.stored.size(), scratch)?;
    let mut stored = (0..count).map(|index| coding.stored.value(&scratch.plain, index));
    out.clear();
    out.extend((0..all).filter_map(|n| {
        let left_out = reduced && !is_set(mask, n);
        if left_out { Some(omission.values[usize::from(is_set(&selection, n))]) } else { stored.next() }
    }));
    Ok(())
}

fn omission<V: Value, R: Read + Seek>(
    input: &mut Input<R>,
    coding: Coding,
    background: V,
) -> Result<Omission<V>> {
    let [kind] = input.array()?;
    let mut first = background.negated();
    let mut second = background;
    match kind {
        0 => first = background,
        2 | 4 => first = single(input, coding)?,
        5 => (first, second) = (single(input, coding)?, single(input, coding)?),
        1 | 3 | 6 => (),
        _ => return Err(Problem::damage("a known kind of node", kind.to_string())),
    }
    Ok(Omission { none: kind == 6, values: [first, second], selects: matches!(kind, 3..=5) })
}

/// The next `count` bytes of values, unpacked, become `scratch.plain`.
fn unpack<R: Read + Seek>(
    input: &mut Input<R>,
    coding: Coding,
    count: usize,
    scratch: &mut Scratch,
) -> Result<()> {
    // OpenVDB writes not even a length for no half numbers at all, though it does for no others.
    let nothing = count == 0 && coding.stored == Format::Half;
    if nothing || coding.packing & (ZIP | BLOSC) == 0 {
        return input.load(&mut scratch.plain, count as u64);
    }
    let length = input.i64()?;
    if length <= 0 {
        // What would not become shorter is stored as it was.
        if length.unsigned_abs() != count as u64 {
            return Err(Problem::damage(
                format!("{count} bytes of values"),
                length.unsigned_abs().to_string(),
            ));
        }
        return input.load(&mut scratch.plain, count as u64);
    }
    input.load(&mut scratch.packed, length.unsigned_abs())?;
    if coding.packing & BLOSC != 0 {
        blosc::unpack(&scratch.packed, count, &mut scratch.plain)
    } else {
        inflate::unpack(&scratch.packed, count as u64, &mut scratch.plain)
    }
}
