//! Learning from a few samples, before an image and while it is made: which strategies are worth their time, where light
//! subpaths should start, which way walks should go, and what radiance previews end in.

mod follower;
mod paths;
pub mod pilot;
mod radiance;
mod tiles;
pub mod training;
mod trial;
