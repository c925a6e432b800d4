//! A mail relay that speaks SMTP (RFC 5321) and behaves as the test sets.

use std::collections::VecDeque;
use std::future::pending;
use std::sync::{Arc, Mutex};
use tokio::io::{AsyncBufReadExt, AsyncRead, AsyncWrite, AsyncWriteExt, BufReader};
use tokio::net::{TcpListener, TcpStream};
use tokio_rustls::TlsAcceptor;

/// Stage of an SMTP session, before the reply there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    Greeting,
    Recipient,
    Data,
    /// After the last line of the message.
    End,
    Quit,
}

/// Behaviour of the relay in one session.
#[derive(Clone, Copy, Debug)]
pub enum Behaviour {
    Accept,
    Reply(Stage, &'static str),
    Hang(Stage),
    Drop(Stage),
}

/// A message handed over, whether the relay accepted it or not.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Letter {
    pub from: String,
    pub to: Vec<String>,
    pub text: String,
    pub encrypted: bool,
}

#[derive(Clone, Default)]
pub struct Relay {
    pub port: u16,
    letters: Arc<Mutex<Vec<Letter>>>,
    commands: Arc<Mutex<Vec<String>>>,
    behaviours: Arc<Mutex<VecDeque<Behaviour>>>,
}

/// Encryption that the relay offers.
#[derive(Clone, Default)]
pub enum Encryption {
    #[default]
    Nothing,
    Start(TlsAcceptor),
    Always(TlsAcceptor),
}

impl Relay {
    pub async fn start() -> Relay {
        Relay::start_with(Encryption::Nothing).await
    }

    pub async fn start_with(encryption: Encryption) -> Relay {
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let relay = Relay {
            port: listener.local_addr().unwrap().port(),
            ..Relay::default()
        };
        let answering = relay.clone();
        tokio::spawn(async move {
            while let Ok((stream, _)) = listener.accept().await {
                let (relay, encryption) = (answering.clone(), encryption.clone());
                tokio::spawn(async move { relay.receive(stream, encryption).await });
            }
        });
        relay
    }

    /// Sets the behaviour of the next session that has none yet.
    pub fn behave_next(&self, behaviour: Behaviour) {
        self.behaviours.lock().unwrap().push_back(behaviour);
    }

    pub fn letters(&self) -> Vec<Letter> {
        self.letters.lock().unwrap().clone()
    }

    /// Returns every command it received, without the messages.
    pub fn commands(&self) -> Vec<String> {
        self.commands.lock().unwrap().clone()
    }

    async fn receive(&self, stream: TcpStream, encryption: Encryption) {
        let behaviour = self.behaviours.lock().unwrap().pop_front();
        let behaviour = behaviour.unwrap_or(Behaviour::Accept);
        match encryption {
            Encryption::Nothing => {
                self.talk(stream, behaviour, true, None).await;
            }
            Encryption::Always(acceptor) => {
                if let Ok(stream) = acceptor.accept(stream).await {
                    self.talk(stream, behaviour, true, Some(true)).await;
                }
            }
            Encryption::Start(acceptor) => {
                let Some(stream) = self.talk(stream, behaviour, true, Some(false)).await else {
                    return;
                };
                if let Ok(stream) = acceptor.accept(stream).await {
                    self.talk(stream, behaviour, false, Some(true)).await;
                }
            }
        }
    }

    /// Serves one session. Returns the stream when it is to be encrypted. `encrypted` is
    /// `None` for a relay without encryption.
    async fn talk<S>(
        &self,
        stream: S,
        behaviour: Behaviour,
        greets: bool,
        encrypted: Option<bool>,
    ) -> Option<S>
    where
        S: AsyncRead + AsyncWrite + Unpin,
    {
        let mut stream = BufReader::new(stream);
        if greets {
            response(&mut stream, behaviour, Stage::Greeting, "220 relay.example").await?;
        }
        let (mut from, mut to) = (String::new(), Vec::new());
        loop {
            let line = read_line(&mut stream).await?;
            self.commands.lock().unwrap().push(line.clone());
            let word = line.to_ascii_uppercase();
            if word.starts_with("EHLO") {
                let offers = match encrypted {
                    Some(false) => "250-relay.example\r\n250 STARTTLS",
                    Some(true) => "250-relay.example\r\n250 AUTH PLAIN",
                    None => "250 relay.example",
                };
                say(&mut stream, offers).await?;
            } else if word == "STARTTLS" {
                say(&mut stream, "220 go ahead").await?;
                return Some(stream.into_inner());
            } else if word.starts_with("AUTH") {
                say(&mut stream, "235 welcome").await?;
            } else if let Some(rest) = line.strip_prefix("MAIL FROM:") {
                from = rest.trim().to_owned();
                say(&mut stream, "250 ok").await?;
            } else if let Some(rest) = line.strip_prefix("RCPT TO:") {
                to.push(rest.trim().to_owned());
                response(&mut stream, behaviour, Stage::Recipient, "250 ok").await?;
            } else if word == "DATA" {
                if !response(&mut stream, behaviour, Stage::Data, "354 go on").await? {
                    continue;
                }
                let letter = Letter {
                    from: from.clone(),
                    to: std::mem::take(&mut to),
                    text: read_letter(&mut stream).await?,
                    encrypted: encrypted == Some(true),
                };
                self.letters.lock().unwrap().push(letter);
                response(&mut stream, behaviour, Stage::End, "250 taken").await?;
            } else if word == "QUIT" {
                response(&mut stream, behaviour, Stage::Quit, "221 bye").await?;
                return None;
            } else {
                say(&mut stream, "500 what?").await?;
            }
        }
    }
}

/// Replies at a stage. Returns `false` for an unusual reply, `None` when the session is
/// over.
async fn response<S>(stream: &mut S, behaviour: Behaviour, at: Stage, usual: &str) -> Option<bool>
where
    S: AsyncWrite + Unpin,
{
    match behaviour {
        Behaviour::Reply(place, line) if place == at => {
            say(stream, line).await?;
            Some(false)
        }
        Behaviour::Hang(place) if place == at => pending().await,
        Behaviour::Drop(place) if place == at => None,
        _ => {
            say(stream, usual).await?;
            Some(true)
        }
    }
}

async fn say<S: AsyncWrite + Unpin>(stream: &mut S, line: &str) -> Option<()> {
    stream
        .write_all(format!("{line}\r\n").as_bytes())
        .await
        .ok()?;
    stream.flush().await.ok()
}

async fn read_line<S: AsyncBufReadExt + Unpin>(stream: &mut S) -> Option<String> {
    let mut line = String::new();
    let read = stream.read_line(&mut line).await.ok()?;
    (read > 0).then(|| line.trim_end_matches(['\r', '\n']).to_owned())
}

/// Reads up to the line with only a full stop, and undoes doubled ones (section 4.5.2).
async fn read_letter<S: AsyncBufReadExt + Unpin>(stream: &mut S) -> Option<String> {
    let mut text = String::new();
    loop {
        let line = read_line(stream).await?;
        if line == "." {
            return Some(text);
        }
        text.push_str(line.strip_prefix('.').unwrap_or(&line));
        text.push_str("\r\n");
    }
}
