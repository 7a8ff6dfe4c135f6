//! Which triangles of a mesh are turned over against their neighbours.

use std::collections::HashMap;

/// A triangle that has an edge, and whether it runs along it from the lower to the higher end.
type Use = (usize, bool);

/// Of every triangle, whether it has to be turned over so that each runs along a shared edge the other way than its
/// neighbour; in each connected part the fewer are turned. None where all agree. Edges of more than two triangles connect
/// nothing.
pub(super) fn turned_over<V: Copy + Ord + std::hash::Hash>(triangles: &[[V; 3]]) -> Option<Vec<bool>> {
    let mut edges: HashMap<[V; 2], Vec<Use>> = HashMap::new();
    for (index, [a, b, c]) in triangles.iter().enumerate() {
        for [from, to] in [[*a, *b], [*b, *c], [*c, *a]] {
            edges.entry([from.min(to), from.max(to)]).or_default().push((index, from < to));
        }
    }
    let mut neighbours = vec![Vec::new(); triangles.len()];
    let mut disagree = false;
    for uses in edges.values() {
        if let [(a, along), (b, back)] = uses[..] {
            disagree |= along == back;
            neighbours[a].push((b, along == back));
            neighbours[b].push((a, along == back));
        }
    }
    disagree.then(|| turns(&neighbours))
}

/// Walks over each connected part from its first triangle.
fn turns(neighbours: &[Vec<Use>]) -> Vec<bool> {
    let mut turned: Vec<Option<bool>> = vec![None; neighbours.len()];
    for first in 0..neighbours.len() {
        if turned[first].is_some() {
            continue;
        }
        turned[first] = Some(false);
        let mut part = vec![first];
        let mut next = 0;
        while let Some(&index) = part.get(next) {
            for (other, disagrees) in &neighbours[index] {
                if turned[*other].is_none() {
                    turned[*other] = turned[index].map(|turn| turn != *disagrees);
                    part.push(*other);
                }
            }
            next += 1;
        }
        let count = part.iter().filter(|index| turned[**index] == Some(true)).count();
        if 2 * count > part.len() {
            part.iter().for_each(|index| turned[*index] = turned[*index].map(|turn| !turn));
        }
    }
    turned.into_iter().map(|turn| turn == Some(true)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TETRAHEDRON: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]];

    #[test]
    fn the_fewer_are_turned() {
        assert_eq!(turned_over(&TETRAHEDRON), None);
        for odd in 0..4 {
            let mut triangles = TETRAHEDRON;
            triangles[odd].swap(1, 2);
            let expected: Vec<bool> = (0..4).map(|index| index == odd).collect();
            assert_eq!(turned_over(&triangles), Some(expected));
        }
    }
}
