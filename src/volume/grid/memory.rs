//! Rejects grids that do not fit into memory before any of it is allocated.

use crate::error::{Error, Result};
use std::path::Path;
use sysinfo::System;

/// What this process may still take [bytes]: the least of what the machine and its container have left.
fn available() -> u64 {
    let mut system = System::new();
    system.refresh_memory();
    let left = system.cgroup_limits().map_or(u64::MAX, |limits| limits.free_memory);
    system.available_memory().min(left)
}

/// An error unless `bytes` (none where no number holds them) are free for the grid of `size` voxels in `path`.
pub fn check(path: &Path, size: [usize; 3], bytes: Option<u64>) -> Result<()> {
    check_against(path, size, bytes, available())
}

fn check_against(path: &Path, [x, y, z]: [usize; 3], bytes: Option<u64>, available: u64) -> Result<()> {
    if bytes.is_some_and(|bytes| bytes <= available) {
        return Ok(());
    }
    let needed = bytes.map_or("more than 2^64 bytes".into(), gibibytes);
    let expected = format!("a grid within the free memory of {}", gibibytes(available));
    let found = format!("{x} x {y} x {z} voxels, which may need {needed}");
    Err(Error::new(path.display(), expected, found, "give a coarser or smaller grid, or more memory"))
}

fn gibibytes(bytes: u64) -> String {
    format!("{:.2} GiB", bytes as f64 / (1u64 << 30) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_not_fit_is_refused_with_its_size() {
        let path = Path::new("a.vol");
        assert!(check_against(path, [4, 5, 6], Some(100), 100).is_ok());
        let error = check_against(path, [4, 5, 6], Some(3 << 30), 1 << 30).unwrap_err();
        let reported = "a.vol: expected a grid within the free memory of 1.00 GiB, \
                    found 4 x 5 x 6 voxels, which may need 3.00 GiB";
        assert!(error.to_string().starts_with(reported), "{error}");
        let error = check_against(path, [usize::MAX; 3], None, 1 << 30).unwrap_err();
        assert!(error.found.ends_with("more than 2^64 bytes"), "{error}");
    }

    #[test]
    fn this_machine_has_some_memory_but_not_all() {
        assert!(check(Path::new("a.vol"), [1; 3], Some(1 << 20)).is_ok());
        assert!(check(Path::new("a.vol"), [1; 3], Some(1 << 60)).is_err());
    }
}
