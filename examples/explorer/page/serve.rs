//! Serves one page on the loopback address.
use std::io::{BufRead, BufReader, Result, Write};
use std::net::{TcpListener, TcpStream};

fn answer(mut stream: TcpStream, page: &[u8]) -> Result<()> {
    // The request, whatever it asks for, ends with an empty line.
    for line in BufReader::new(&stream).lines() {
        if line?.is_empty() {
            break;
        }
    }
    let head = "HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Type: text/html; charset=utf-8";
    write!(stream, "{head}\r\nContent-Length: {}\r\n\r\n", page.len())?;
    stream.write_all(page)
}

fn main() -> Result<()> {
    let page: &[u8] = std::fs::read(std::env::args().nth(1).unwrap_or_default())?.leak();
    let listener = TcpListener::bind("127.0.0.1:8034")?;
    println!("http://{}/", listener.local_addr()?);
    for stream in listener.incoming() {
        let stream = stream?;
        // A browser may open a connection and not use it, or go away before it has all.
        std::thread::spawn(move || answer(stream, page).ok());
    }
    Ok(())
}
