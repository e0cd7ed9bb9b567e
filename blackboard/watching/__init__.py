"""What people watch a board with: graphs of who posts what, tables of what comes, summaries, findings about the setup."""
