//! The picture so far in the viewer tev, over the network.

use crate::{
    error::{Error, Result},
    render::sums::Picture,
};
use std::{
    io,
    net::{TcpStream, ToSocketAddrs},
    time::Duration,
};
use tev_client::{PacketCreateImage, PacketUpdateImage, TevClient};

/// A viewer that takes longer is not there.
const PATIENCE: Duration = Duration::from_secs(2);

/// What the picture is called there.
const NAME: &str = "tyndall";
const CHANNELS: [&str; 3] = ["R", "G", "B"];

/// A connection to tev.
pub(super) struct Viewer {
    client: TevClient,
    address: String,
    is_new: bool,
}

impl Viewer {
    /// Connects to `address`, a host and port.
    pub(super) fn connect(address: &str) -> Result<Self> {
        let socket = connected(address).map_err(|error| explain(address, &error))?;
        Ok(Self { client: TevClient::wrap(socket), address: address.to_owned(), is_new: true })
    }

    /// Shows a picture.
    pub(super) fn show(&mut self, picture: &dyn Picture) -> Result<()> {
        self.send(picture).map_err(|error| explain(&self.address, &error))
    }

    fn send(&mut self, picture: &dyn Picture) -> io::Result<()> {
        let size = |pixels: usize| u32::try_from(pixels).map_err(io::Error::other);
        let (width, height) = picture.size();
        let (width, height) = (size(width)?, size(height)?);
        let (image_name, channel_names) = (NAME, &CHANNELS[..]);
        if std::mem::take(&mut self.is_new) {
            self.client.send(PacketCreateImage {
                image_name,
                grab_focus: true,
                width,
                height,
                channel_names,
            })?;
        }
        let data: Vec<f32> = picture.image().pixels.iter().flat_map(|pixel| pixel.to_array()).collect();
        self.client.send(PacketUpdateImage {
            image_name,
            grab_focus: false,
            channel_names,
            channel_offsets: &[0, 1, 2],
            channel_strides: &[3, 3, 3],
            x: 0,
            y: 0,
            width,
            height,
            data: &data,
        })
    }
}

/// A socket that blocks for [`PATIENCE`] at most.
fn connected(address: &str) -> io::Result<TcpStream> {
    let first = address.to_socket_addrs()?.next().ok_or(io::ErrorKind::NotFound)?;
    let socket = TcpStream::connect_timeout(&first, PATIENCE)?;
    socket.set_write_timeout(Some(PATIENCE))?;
    Ok(socket)
}

fn explain(address: &str, error: &io::Error) -> Error {
    let remedy = "start tev first, or name the host and port where it listens";
    Error::new("--tev", format!("tev at {address}"), error.to_string(), remedy)
}
