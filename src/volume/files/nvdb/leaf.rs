//! The values of a NanoVDB block: plain, or quantised between the block's least and greatest.

use super::{
    super::{
        Result,
        sparse::BLOCK,
        value::{Format, Value, array},
    },
    image::Image,
};

/// How a block's values are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Leaf {
    /// As they are.
    Plain,
    /// As codes of so many bits.
    Bits(usize),
    /// As codes of as many bits as the block says.
    AnyBits,
}

/// Places within a block (bytes): its flags, the mask of active values, and what follows that.
const FLAGS: usize = 15;
const MASK: usize = 16;
const REST: usize = MASK + BLOCK / 8;

/// Where codes start; before them are the least value and the step between codes (bytes).
const CODES: usize = 96;

impl Leaf {
    /// The least length of a block (bytes).
    pub(super) fn shortest<V: Value>(self) -> usize {
        match self {
            Self::Plain => plain_start::<V>() + BLOCK * V::CHANNELS * 4,
            Self::Bits(bits) => CODES + BLOCK * bits / 8,
            Self::AnyBits => CODES + BLOCK / 8,
        }
    }

    /// The mask and the values of the block at `at`.
    pub(super) fn read<V: Value>(self, image: &Image, at: usize) -> Result<(&[u8], [V; BLOCK])> {
        let head = image.bytes(at, CODES)?;
        let values = match self {
            Self::Plain => {
                let bytes = image.bytes(at + plain_start::<V>(), BLOCK * V::CHANNELS * 4)?;
                std::array::from_fn(|n| Format::Float.value(bytes, n))
            }
            Self::Bits(bits) => quantised(head, bits, image.bytes(at + CODES, BLOCK * bits / 8)?),
            Self::AnyBits => {
                // 1, 2, 4, 8 or 16; the three bits can say more than is ever written.
                let bits = 1 << (head[FLAGS] >> 5).min(4);
                quantised(head, bits, image.bytes(at + CODES, BLOCK * bits / 8)?)
            }
        };
        Ok((&head[MASK..REST], values))
    }
}

/// Where plain values start: after the least, the greatest, and two numbers about them, at a multiple of 32.
fn plain_start<V: Value>() -> usize {
    (REST + 2 * V::CHANNELS * 4 + 2 * 4).next_multiple_of(32)
}

fn quantised<V: Value>(head: &[u8], bits: usize, codes: &[u8]) -> [V; BLOCK] {
    let [least, step] = [REST, REST + 4].map(|at| f32::from_le_bytes(array(head, at)));
    let code = |n: usize| match bits {
        16 => f32::from(u16::from_le_bytes(array(codes, 2 * n))),
        8 => f32::from(codes[n]),
        _ => {
            let start = n * bits;
            f32::from(codes[start >> 3] >> (start & 7) & ((1 << bits) - 1))
        }
    };
    std::array::from_fn(|n| V::from_numbers(|_| code(n) * step + least))
}
