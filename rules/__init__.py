"""What users edit: mission files that say which components make up a run, and with which parameters."""
