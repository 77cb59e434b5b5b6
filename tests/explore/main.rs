//! Tests of the server and the exported page of `merlkit explore`.
