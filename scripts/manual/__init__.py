"""The manual: its pages read and checked, its tables, and the site of its pages and the API."""
