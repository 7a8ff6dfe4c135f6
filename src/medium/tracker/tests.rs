//! Trackers against quadrature and against each other.
