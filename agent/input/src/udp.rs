//! Sentences in datagrams: plain ones to a local port, or those of an IEC 61162-450 network to its
//! multicast groups.
//!
//! Senders of datagrams do not wait: what does not fit is dropped and counted.

use super::decode::Decoder;
use super::link::{End, Link};
use crate::config::Group;
use socket2::{Domain, Protocol, Socket, Type};
use std::io;
use std::net::SocketAddr;
use tokio::net::UdpSocket;

const MAX_DATAGRAM_BYTES: usize = 65_536;
/// Datagrams that are delivered together when they are already waiting.
const MAX_DATAGRAMS_AT_ONCE: usize = 64;
/// Receive buffer for bursts while the agent is busy.
const RECEIVE_BUFFER_BYTES: usize = 1024 * 1024;

pub(crate) async fn unicast(address: SocketAddr, link: &Link) -> io::Result<End> {
    let socket = Socket::new(Domain::for_address(address), Type::DGRAM, None)?;
    socket.bind(&address.into())?;
    receive(socket, Decoder::plain_datagram, link).await
}

pub(crate) async fn multicast(group: &Group, link: &Link) -> io::Result<End> {
    let socket = Socket::new(Domain::IPV4, Type::DGRAM, Some(Protocol::UDP))?;
    // Others on this machine may listen to the same group.
    socket.set_reuse_address(true)?;
    // Bound to the group itself, so that other groups on the port stay out.
    socket.bind(&SocketAddr::V4(group.address).into())?;
    socket.join_multicast_v4(group.address.ip(), &group.interface)?;
    receive(socket, Decoder::tagged_datagram, link).await
}

async fn receive(socket: Socket, decode: fn(&mut Decoder, &[u8]), link: &Link) -> io::Result<End> {
    socket.set_nonblocking(true)?;
    socket.set_recv_buffer_size(RECEIVE_BUFFER_BYTES)?;
    let socket = UdpSocket::from_std(socket.into())?;
    link.opened();
    let mut decoder = Decoder::new(link.name.clone());
    let mut buffer = vec![0; MAX_DATAGRAM_BYTES];
    loop {
        let mut waiting = Some(socket.recv_from(&mut buffer).await?);
        let (mut datagrams, mut bytes) = (0, 0);
        while let Some((count, sender)) = waiting {
            decoder.set_sender(sender.ip());
            decode(&mut decoder, &buffer[..count]);
            datagrams += 1;
            bytes += count;
            let more = datagrams < MAX_DATAGRAMS_AT_ONCE;
            waiting = more
                .then(|| socket.try_recv_from(&mut buffer).ok())
                .flatten();
        }
        link.stats.count_received(bytes, &decoder.take_tally());
        link.offer(decoder.take_observations())?;
    }
}
