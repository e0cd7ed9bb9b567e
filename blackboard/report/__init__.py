"""What a run leaves behind: its table, its files, its pictures, and how good its map is."""
