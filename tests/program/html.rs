//! A page of HTML as a browser's parser sees it, and CSS selectors on it.

use html5gum::{DefaultEmitter, HtmlString, StartTag, Token, Tokenizer};
use roxmltree::{Document, Node};
use simplecss::{AttributeOperator, PseudoClass, Selector};

/// Elements that have no end tag.
const VOID: &str = "area base br col embed hr img input link meta source track wbr";
/// Elements that end a paragraph.
const BLOCKS: &str = "address article aside blockquote details dialog dir div dl fieldset figcaption figure footer \
    form h1 h2 h3 h4 h5 h6 header hgroup hr main menu nav ol p pre search section summary table ul";

/// The tree of a page; panics if a parser would have to repair anything.
pub(crate) fn parse(page: &str) -> Document<'static> {
    assert!(page.starts_with("<!DOCTYPE html>"), "{page:.80}");
    let mut emitter = DefaultEmitter::default();
    emitter.naively_switch_states(true);
    let (mut xml, mut svgs) = (String::new(), 0);
    for Ok(token) in Tokenizer::new_with_emitter(page, emitter) {
        match token {
            Token::Doctype(_) => assert_eq!(xml, ""),
            Token::StartTag(tag) => {
                svgs += i32::from(*tag.name == b"svg");
                xml += &opened(&tag, svgs > 0);
            }
            Token::EndTag(tag) => {
                svgs -= i32::from(*tag.name == b"svg");
                xml += &format!("</{}>", text(&tag.name));
            }
            // Between the doctype, the root and the end there may be line feeds, but no references to them.
            Token::String(content) if text(&content).trim().is_empty() => xml += text(&content),
            Token::String(content) => xml += &escaped(&content),
            Token::Comment(_) => {}
            Token::Error(error) => panic!("{}", *error),
        }
    }
    let tree = Document::parse(xml.leak()).unwrap();
    assert_eq!(tree.descendants().find(is_misplaced), None);
    tree
}

/// A start tag of XML. Outside of SVG, the slash of `<a/>` means nothing.
fn opened(tag: &StartTag<()>, is_svg: bool) -> String {
    let is_empty = contains(VOID, text(&tag.name)) || tag.self_closing && is_svg;
    let attributes = tag.attributes.iter();
    let attributes: String =
        attributes.map(|(name, value)| format!(" {}=\"{}\"", text(name), escaped(value))).collect();
    format!("<{}{attributes}{}>", text(&tag.name), if is_empty { "/" } else { "" })
}

fn text(bytes: &HtmlString) -> &str {
    str::from_utf8(bytes).unwrap()
}

fn escaped(bytes: &HtmlString) -> String {
    let escape = |c: char| match c {
        '<' | '>' | '&' | '"' | '\0'..' ' => format!("&#{};", u32::from(c)),
        _ => c.into(),
    };
    text(bytes).chars().map(escape).collect()
}

fn contains(names: &str, name: &str) -> bool {
    names.split(' ').any(|known| known == name)
}

/// What a parser would move out of a paragraph or a table.
fn is_misplaced(node: &Node) -> bool {
    let name = node.tag_name().name();
    let is_blank = node.text().is_none_or(|text| text.trim().is_empty());
    match node.parent().map_or("", |parent| parent.tag_name().name()) {
        _ if contains(BLOCKS, name) && node.ancestors().skip(1).any(|outer| outer.has_tag_name("p")) => true,
        "table" => !(contains("caption colgroup thead tbody tfoot", name) || node.is_text() && is_blank),
        "thead" | "tbody" | "tfoot" => !(name == "tr" || node.is_text() && is_blank),
        "tr" => !(contains("th td", name) || node.is_text() && is_blank),
        _ => false,
    }
}

/// All elements that a list of selectors matches.
pub(crate) fn all<'a>(page: &'a Document, query: &str) -> Vec<Node<'a, 'a>> {
    let selectors: Vec<_> = query.split(',').map(|part| Selector::parse(part.trim()).unwrap()).collect();
    let is_match = |node: &Node| selectors.iter().any(|selector| selector.matches(&Element(*node)));
    page.descendants().filter(|node| node.is_element() && is_match(node)).collect()
}

/// Those of them that are not hidden.
pub(crate) fn shown<'a>(page: &'a Document, query: &str) -> Vec<Node<'a, 'a>> {
    let is_shown = |node: &Node| !node.ancestors().any(|outer| outer.has_attribute("hidden"));
    all(page, query).into_iter().filter(is_shown).collect()
}

/// Their texts.
pub(crate) fn texts(page: &Document, query: &str) -> Vec<String> {
    let text = |node: &Node| {
        node.descendants().filter(Node::is_text).filter_map(|part| part.text()).collect::<String>()
    };
    all(page, query).iter().map(|node| text(node).trim().to_owned()).collect()
}

struct Element<'a>(Node<'a, 'a>);

impl simplecss::Element for Element<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Element)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Element)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.has_tag_name(name)
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass) -> bool {
        panic!("\":{class}\" is not one of the selectors here")
    }
}

#[test]
fn what_a_parser_would_repair_is_refused() {
    let is_refused = |body: &str| {
        let page = format!("<!DOCTYPE html><html><body>{body}</body></html>");
        std::panic::catch_unwind(|| parse(&page)).is_err()
    };
    let table = "<table> <tbody><tr><td>a</td></tr></tbody></table>";
    for body in ["<p>a<br>b</p>", table, "<svg><g/></svg>", "<script>a<b && c</script>"] {
        assert!(!is_refused(body), "{body}");
    }
    for body in [
        "<p><b><div>a</div></b></p>",
        "<table>a</table>",
        "<table><p>a</p></table>",
        "<b><i>a</b></i>",
        "<ul><li>a</ul>",
        "<div/>",
        "<b x='1' x='2'>a</b>",
        "<b x=1\"2>a</b>",
        "a &amp b",
        "a < b",
        "</br>",
        "<script>a</script",
        "\u{1}",
    ] {
        assert!(is_refused(body), "{body}");
    }
}
