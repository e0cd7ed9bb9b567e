"""The command line `ski`: one module for each verb."""
