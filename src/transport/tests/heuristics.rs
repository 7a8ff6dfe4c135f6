//! The heuristics as they are defined, over n p of all strategies and channels of a path at once.

use crate::{settings::heuristic::Heuristic, transport::mis::TIE};

/// Weights by strategy and hero for these ln(n_s p_s^c), each in [0, 1]: they sum to one.
pub(super) fn weights(heuristic: Heuristic, logs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let most = most(logs);
    match heuristic {
        Heuristic::Balance => shares(logs, |log| (log - most).exp()),
        Heuristic::Power => shares(logs, |log| (2.0 * (log - most)).exp()),
        Heuristic::Maximum => shares(logs, |log| if most - log <= tie() { 1.0 } else { 0.0 }),
        Heuristic::Cutoff { alpha } => {
            let least = most + f64::from(alpha).ln();
            shares(logs, |log| if log >= least { (log - most).exp() } else { 0.0 })
        }
        Heuristic::Uniform => uniform(logs),
    }
}

/// True if some n p lies so close to where `heuristic` jumps that errors of `slack`, relative, may decide.
pub(super) fn is_close(heuristic: Heuristic, logs: &[Vec<f64>], slack: f64) -> bool {
    let most = most(logs);
    let below = || logs.iter().flatten().map(|log| most - log);
    match heuristic {
        Heuristic::Balance | Heuristic::Power | Heuristic::Uniform => false,
        // Channels of equal extinction are tied exactly. Ties of ties are within three times that: by which of them
        // the fast code goes depends on its order.
        Heuristic::Maximum => {
            below().any(|gap| gap > 0.0 && gap + slack > 0.5 * tie() && gap - slack < 3.0 * tie())
        }
        Heuristic::Cutoff { alpha } => below().any(|gap| (gap + f64::from(alpha).ln()).abs() < slack),
    }
}

fn most(logs: &[Vec<f64>]) -> f64 {
    logs.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn tie() -> f64 {
    f64::from(TIE).ln_1p()
}

fn shares(logs: &[Vec<f64>], of: impl Fn(f64) -> f64) -> Vec<Vec<f64>> {
    let total: f64 = logs.iter().flatten().map(|log| of(*log)).sum();
    logs.iter().map(|strategy| strategy.iter().map(|log| of(*log) / total).collect()).collect()
}

/// Every strategy that any hero can make the path by has the same part, which its heroes share by the balance
/// heuristic.
fn uniform(logs: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let is_possible = |strategy: &&Vec<f64>| strategy.iter().any(|log| *log > f64::NEG_INFINITY);
    let count = logs.iter().filter(is_possible).count() as f64;
    let of_strategy = |strategy: &Vec<f64>| match is_possible(&strategy) {
        false => vec![0.0; strategy.len()],
        true => {
            let heroes = weights(Heuristic::Balance, std::slice::from_ref(strategy));
            heroes.into_iter().flatten().map(|weight| weight / count).collect()
        }
    };
    logs.iter().map(of_strategy).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three strategies of two channels with n p = 4, 1; 2, 0; 0, 0.
    fn logs() -> Vec<Vec<f64>> {
        [[4.0f64, 1.0], [2.0, 0.0], [0.0, 0.0]].map(|strategy| strategy.map(f64::ln).to_vec()).to_vec()
    }

    #[test]
    fn by_hand() {
        for (heuristic, expected) in [
            (Heuristic::Balance, [4.0 / 7.0, 1.0 / 7.0, 2.0 / 7.0, 0.0]),
            (Heuristic::Power, [16.0 / 21.0, 1.0 / 21.0, 4.0 / 21.0, 0.0]),
            (Heuristic::Maximum, [1.0, 0.0, 0.0, 0.0]),
            (Heuristic::Cutoff { alpha: 0.3 }, [4.0 / 6.0, 0.0, 2.0 / 6.0, 0.0]),
            (Heuristic::Cutoff { alpha: 0.2 }, [4.0 / 7.0, 1.0 / 7.0, 2.0 / 7.0, 0.0]),
            (Heuristic::Uniform, [0.4, 0.1, 0.5, 0.0]),
        ] {
            let found: Vec<f64> = weights(heuristic, &logs()).into_iter().flatten().collect();
            for (found, expected) in found.iter().zip(expected.iter().chain(&[0.0, 0.0])) {
                assert!((found - expected).abs() < 1e-15, "{heuristic}: {found} {expected}");
            }
        }
    }
}
