"""The compliant prediction: a body on springs over feet that rub, step by step."""
