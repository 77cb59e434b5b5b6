//! The server and the exported page of `merlkit explore`.

mod answers;
mod hostile;
mod read;
mod sockets;
mod stored_page;
