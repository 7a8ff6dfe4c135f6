//! Markup that means nothing in a scene, blanked out: people write comments that XML forbids (`<!-- ---- lamps ---- -->`),
//! blanks before the declaration and document types, and Mitsuba reads them all.

/// `text` with spaces in place of comments, declarations and document types. What is left stays where it was; markup that
/// does not end is left for the parser to complain about.
pub(super) fn blanked(text: &str) -> String {
    let (mut blanked, mut rest) = (String::with_capacity(text.len()), text);
    while let Some(start) = rest.find('<') {
        let (before, markup) = rest.split_at(start);
        let Some((length, is_blank)) = extent(markup) else { break };
        blanked.push_str(before);
        let (markup, after) = markup.split_at(length);
        match is_blank {
            true => blanked.extend(markup.bytes().map(|b| if b == b'\n' { '\n' } else { ' ' })),
            false => blanked.push_str(markup),
        }
        rest = after;
    }
    blanked + rest
}

/// How many bytes the markup takes that `text` begins with, and whether it means nothing; none where it does not end.
fn extent(text: &str) -> Option<(usize, bool)> {
    let until = |end: &str| text.find(end).map(|at| at + end.len());
    match text {
        t if t.starts_with("<!--") => Some((4 + t[4..].find("-->")? + 3, true)),
        t if t.starts_with("<![CDATA[") => Some((until("]]>")?, false)),
        t if t.starts_with("<?") => Some((until("?>")?, true)),
        t if t.starts_with("<!DOCTYPE") => Some((document_type(t)?, true)),
        t => Some((tag(t)?, false)),
    }
}

/// The length of a document type, which may hold declarations in brackets.
fn document_type(text: &str) -> Option<usize> {
    let end = text.find('>')?;
    if text[..end].contains('[') {
        let close = text.find(']')?;
        return Some(close + text[close..].find('>')? + 1);
    }
    Some(end + 1)
}

/// The length of a tag, whose attributes may hold a `>`.
fn tag(text: &str) -> Option<usize> {
    let mut quote = None;
    let end = text.bytes().position(|byte| {
        match quote {
            Some(open) if byte == open => quote = None,
            None if byte == b'"' || byte == b'\'' => quote = Some(byte),
            _ => {}
        }
        quote.is_none() && byte == b'>'
    });
    end.map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_means_nothing_goes_and_nothing_moves() {
        for [before, gone, after] in [
            ["<a>", "<!-- -- é --- -->", "<b/></a>"],
            ["", " <?xml version=\"1.0\"?>", "<a/>"],
            ["", "<!DOCTYPE scene SYSTEM \"x.dtd\">", "<a/>"],
            ["", "<!DOCTYPE a [<!ENTITY b \"c\">]>", "<a/>"],
            ["<a b='>' c=\"<!--\" d='\"'/>", "", ""],
            ["<![CDATA[<!-- x -->]]>", "", "<b>"],
        ] {
            assert_eq!(
                blanked(&[before, gone, after].concat()),
                [before, &" ".repeat(gone.len()), after].concat()
            );
        }
        assert_eq!(blanked("<!--\n--><a/>"), "    \n   <a/>");
        for endless in ["<a><!-- b", "<!-->", "<a b=\"", "<!DOCTYPE [", "<?xml", "< ", "<![CDATA[>"] {
            assert_eq!(blanked(endless), endless);
        }
    }
}
