//! What does not fit into memory is refused before any of it is allocated, for an allocation that fails ends the program.

use crate::error::{Error, Result};
use std::fmt::Display;
use sysinfo::System;

/// An error unless `bytes` (none where no number holds them) are free for `what`, which is described by `size`.
pub fn check(place: impl Display, what: &str, size: &str, bytes: Option<u64>, remedy: &str) -> Result<()> {
    let available = available();
    let expected = if bytes.is_none_or(|bytes| bytes > available) {
        format!("{what} within the free memory of {}", gibibytes(available))
    } else if bytes.is_none_or(|bytes| !is_given(bytes)) {
        format!("{what} within the memory that this process is allowed")
    } else {
        return Ok(());
    };
    let needed = bytes.map_or("more than 2^64 bytes".into(), gibibytes);
    Err(Error::new(place, expected, format!("{size}, which may need {needed}"), remedy))
}

/// What this process may still take (bytes): the least of what the machine and its container have left.
fn available() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    let left = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    system.available_memory().min(left)
}

/// True if the system gives this process so many bytes of address space, which limits such as `ulimit -v` are about.
/// They are given back untouched.
fn is_given(bytes: u64) -> bool {
    let mut probe: Vec<u8> = Vec::new();
    let given = usize::try_from(bytes).is_ok_and(|bytes| probe.try_reserve_exact(bytes).is_ok());
    // A compiler may leave out an allocation that nobody looks at.
    std::hint::black_box(&mut probe);
    given
}

fn gibibytes(bytes: u64) -> String {
    format!("{:.2} GiB", bytes as f64 / (1u64 << 30) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(bytes: Option<u64>) -> Result<()> {
        check("a.vol", "a grid", "4 x 5 x 6 voxels", bytes, "give a coarser grid")
    }

    #[test]
    fn what_does_not_fit_is_refused_with_its_size() {
        assert!(grid(Some(1 << 20)).is_ok());
        let error = grid(Some(1 << 60)).unwrap_err();
        assert_eq!(error.found, "4 x 5 x 6 voxels, which may need 1073741824.00 GiB");
        assert!(error.expected.starts_with("a grid within the free memory of "), "{error}");
        assert!(grid(None).unwrap_err().found.ends_with("more than 2^64 bytes"));
    }

    #[test]
    fn the_system_gives_some_address_space_but_not_all() {
        assert!(is_given(1 << 20) && !is_given(1 << 62) && !is_given(u64::MAX));
    }
}
