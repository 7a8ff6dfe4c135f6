//! Serves the page to this machine alone: on the loopback address, to whoever knows the token, under its own name.

use super::board::{Board, Shown, Wish};
use crate::{
    error::{Error, Result},
    film::view::{Exposure, View},
};
use rand::{TryRng as _, rngs::SysRng};
use serde_json::json;
use std::{
    io::{Cursor, Read as _},
    net::{Ipv4Addr, SocketAddr},
    sync::Arc,
    thread,
    time::Duration,
};
use tiny_http::{Header, Method, Request, Response};

/// The page, all of it.
const PAGE: &str = include_str!("page.html");
/// Time between two questions whether it is over.
const NAP: Duration = Duration::from_millis(50);
/// Bytes of gestures that come at once, at most.
const LONGEST: u64 = 1 << 16;

/// What every answer says: nobody keeps it, nobody else shows it, it asks for nothing but what comes from here.
const HEADERS: [(&str, &str); 5] = [
    ("Cache-Control", "no-store"),
    ("Referrer-Policy", "no-referrer"),
    ("X-Content-Type-Options", "nosniff"),
    ("Cross-Origin-Resource-Policy", "same-origin"),
    (
        "Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; connect-src 'self'; \
         img-src data:; frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
    ),
];

type Answer = Response<Cursor<Vec<u8>>>;

/// A server that nobody else reaches.
pub(super) struct Server {
    http: tiny_http::Server,
    port: u16,
    token: String,
}

impl Server {
    /// Listens at `port`, or at any that is free.
    pub(super) fn new(port: Option<u16>) -> Result<Self> {
        let refuse = |found: String| {
            let remedy = "leave it out: a free port is then found";
            Error::new("--port", "a port of this machine that is free", found, remedy)
        };
        let address = SocketAddr::from((Ipv4Addr::LOCALHOST, port.unwrap_or(0)));
        let http = tiny_http::Server::http(address).map_err(|error| refuse(error.to_string()))?;
        let bound = http.server_addr().to_ip().ok_or_else(|| refuse("no address".to_owned()))?;
        let mut secret = [0; 16];
        SysRng.try_fill_bytes(&mut secret).map_err(|error| {
            let remedy = "start the system's source of random numbers";
            Error::new("the system", "random numbers for a token", error.to_string(), remedy)
        })?;
        let token = secret.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { http, port: bound.port(), token })
    }

    /// Where the page is.
    pub(super) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Answers, each question on a thread of its own, until it `is_over`. Nobody waits for these threads: a reader who fell
    /// silent in the middle of an answer would keep the program from its end.
    pub(super) fn serve(self, board: &Arc<Board>, is_over: impl Fn() -> bool) {
        let server = Arc::new(self);
        while !is_over() {
            if let Ok(Some(request)) = server.http.recv_timeout(NAP) {
                let (server, board) = (Arc::clone(&server), Arc::clone(board));
                thread::spawn(move || server.attend(request, &board));
            }
        }
    }

    fn attend(&self, mut request: Request, board: &Board) {
        let answer = self.answer(&mut request, board);
        let headers = HEADERS.iter().filter_map(|(name, value)| Header::from_bytes(*name, *value).ok());
        // Who has gone meanwhile misses nothing.
        let _ = request.respond(headers.fold(answer, Response::with_header));
    }

    fn answer(&self, request: &mut Request, board: &Board) -> Answer {
        if !self.is_meant(request) {
            return text(403, "This server answers under the address that it printed only.");
        }
        let url = request.url().to_owned();
        let inside = url.strip_prefix('/').and_then(|path| path.strip_prefix(self.token.as_str()));
        let (path, query) = inside.map_or(("", ""), |path| path.split_once('?').unwrap_or((path, "")));
        match (request.method(), path) {
            (Method::Get, "/") => page(),
            (Method::Get, "/picture") => picture(board, query),
            (Method::Post, "/wishes") => wishes(board, request),
            _ => text(404, "There is nothing here."),
        }
    }

    /// True if the request names this server. A request under another name comes from a foreign page (DNS rebinding),
    /// which is not to look in.
    fn is_meant(&self, request: &Request) -> bool {
        let mut hosts = request.headers().iter().filter(|header| header.field.equiv("Host"));
        let names = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        let is_own = |header: &Header| names.iter().any(|name| header.value.as_str() == name);
        hosts.next().is_some_and(is_own) && hosts.next().is_none()
    }
}

fn text(code: u16, text: &str) -> Answer {
    Response::from_string(format!("{text}\n")).with_status_code(code)
}

fn page() -> Answer {
    let html = Header::from_bytes("Content-Type", "text/html; charset=utf-8");
    html.into_iter().fold(Response::from_string(PAGE), Response::with_header)
}

/// The picture after that whose number `query` names, once there is one; 204 where none came for a while.
fn picture(board: &Board, query: &str) -> Answer {
    let Some(number) = query.strip_prefix("after=").and_then(|number| number.parse().ok()) else {
        return text(400, "Expected picture?after=NUMBER.");
    };
    match board.after(number) {
        Some(shown) => Response::from_data(bytes(&shown)),
        None => Response::from_data([]).with_status_code(204),
    }
}

/// A line of JSON, then the pixels as a browser draws them: red, green, blue, opaque.
fn bytes(shown: &Shown) -> Vec<u8> {
    let Shown { number, picture, error, display } = shown;
    let view = display.of(&picture.pixels);
    let views: Vec<&str> = View::NAMES.iter().map(|(name, _)| *name).collect();
    let head = json!({
        "number": number, "size": picture.size, "caption": picture.caption, "error": error,
        "views": views, "view": view.view.name(), "exposure": view.stops, "is_auto": display.exposure == Some(Exposure::Auto),
    });
    let mut bytes = format!("{head}\n").into_bytes();
    bytes.reserve(4 * picture.pixels.len());
    view.bytes(&picture.pixels).chunks_exact(3).for_each(|pixel| {
        bytes.extend_from_slice(pixel);
        bytes.push(u8::MAX);
    });
    bytes
}

/// Notes what a user does.
fn wishes(board: &Board, request: &mut Request) -> Answer {
    let mut body = Vec::new();
    let read = request.as_reader().take(LONGEST + 1).read_to_end(&mut body);
    if read.is_err() || body.len() as u64 > LONGEST {
        return text(413, "Expected fewer gestures at once.");
    }
    match serde_json::from_slice::<Vec<Wish>>(&body) {
        Ok(wishes) if wishes.iter().all(|wish| wish.is_possible()) => {
            board.wish(wishes);
            Response::from_data([]).with_status_code(204)
        }
        Ok(_) => text(400, "Expected gestures as a hand makes them."),
        Err(error) => text(400, &format!("Expected a list of gestures: {error}")),
    }
}
