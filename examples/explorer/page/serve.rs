//! Serves one page on the loopback address.
use std::io::{BufRead, BufReader, Write};
use std::net::TcpListener;

fn main() -> std::io::Result<()> {
    let page = std::fs::read(std::env::args().nth(1).unwrap_or_default())?;
    let listener = TcpListener::bind("127.0.0.1:8034")?;
    println!("http://{}/", listener.local_addr()?);
    for stream in listener.incoming() {
        let mut stream = stream?;
        // The request, whatever it asks for, ends with an empty line.
        let lines = BufReader::new(&stream).lines().map_while(Result::ok);
        lines.take_while(|line| !line.is_empty()).for_each(drop);
        let head = "HTTP/1.1 200 OK\r\nConnection: close\r\nContent-Type: text/html";
        // A browser may go away before it has all.
        let _ = write!(stream, "{head}\r\nContent-Length: {}\r\n\r\n", page.len())
            .and_then(|()| stream.write_all(&page));
    }
    Ok(())
}
