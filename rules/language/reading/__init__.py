"""The parts of the reader, one for each layer of the text: tokens, bracketed forms, then what each form means."""
