//! The colours in PLY files, under Mitsuba's names.

/// Numbers of a vertex or a face that belong together.
#[derive(Debug, PartialEq)]
pub(super) struct Group {
    /// As textures call them.
    pub name: String,
    /// One or three of the numbers that have no other meaning.
    pub slots: Vec<usize>,
}

/// Names of colours without a name of their own.
const COLORS: [[&str; 3]; 2] = [["r", "g", "b"], ["red", "green", "blue"]];

/// What may stand behind a name, in order.
const SUFFIXES: [[&str; 3]; 3] = [["r", "g", "b"], ["x", "y", "z"], ["0", "1", "2"]];

/// The groups among the properties `names` of elements called `element`: `r`, `g`, `b` are `vertex_color`, `NAME_r` and so on
/// `vertex_NAME_color`, `NAME_x` and `NAME_0` and so on `vertex_NAME`, the last being how Mitsuba writes meshes.
pub(super) fn groups(element: &str, names: &[&str]) -> Vec<Group> {
    let slot = |name: &str| names.iter().position(|known| *known == name);
    let color = |names: &[&str; 3]| names.iter().map(|name| slot(name)).collect::<Option<Vec<_>>>();
    let colors = COLORS.iter().find_map(color);
    let mut found: Vec<_> =
        colors.map(|slots| Group { name: format!("{element}_color"), slots }).into_iter().collect();
    for (first, name) in names.iter().enumerate() {
        let Some((prefix, suffix)) = name.rsplit_once('_') else { continue };
        let Some(order) = SUFFIXES.iter().find(|order| order[0] == suffix) else { continue };
        let further =
            names[first..].iter().take_while(|next| next.rsplit_once('_').is_some_and(|n| n.0 == prefix));
        let count = further.count();
        let slots: Vec<usize> = (first..first + count).collect();
        let is_ordered = slots
            .iter()
            .zip(order)
            .all(|(i, suffix)| names[*i].rsplit_once('_').is_some_and(|n| n.1 == *suffix));
        let color = if suffix == "r" { "_color" } else { "" };
        if [1, 3].contains(&count) && is_ordered {
            found.push(Group { name: format!("{element}_{prefix}{color}"), slots });
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As Mitsuba 3.9.1 reads them.
    #[test]
    fn groups_are_those_of_mitsuba() {
        let check = |names: &[&str], expected: &[(&str, &[usize])]| {
            let expected: Vec<_> = expected
                .iter()
                .map(|(name, slots)| Group { name: (*name).into(), slots: slots.to_vec() })
                .collect();
            assert_eq!(groups("vertex", names), expected, "{names:?}");
        };
        check(&["r", "g", "b"], &[("vertex_color", &[0, 1, 2])]);
        check(&["red", "green", "blue", "alpha"], &[("vertex_color", &[0, 1, 2])]);
        check(&["color_r", "color_g", "color_b"], &[("vertex_color_color", &[0, 1, 2])]);
        check(
            &["a", "color_0", "color_1", "color_2", "foo_0"],
            &[("vertex_color", &[1, 2, 3]), ("vertex_foo", &[4])],
        );
        check(&["u_foo_x", "u_foo_y", "u_foo_z"], &[("vertex_u_foo", &[0, 1, 2])]);
        check(&["a_x", "b_x", "k_r"], &[("vertex_a", &[0]), ("vertex_b", &[1]), ("vertex_k_color", &[2])]);
        for none in
            [&["foo"][..], &["a_bc"], &["a_q"], &["a_0", "a_1"], &["a_r", "a_g", "a_b", "a_a"], &["r", "g"]]
        {
            check(none, &[]);
        }
    }
}
