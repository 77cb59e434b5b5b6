//! The server and the exported page of `merlkit explore`.

mod anisotropic;
mod answers;
mod hostile;
mod meshes;
mod read;
mod sockets;
mod stored_page;
