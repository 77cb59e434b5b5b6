// The page's script is built here.
