"""Pages of results as a browser reads them."""

import html.parser
import re

FORBIDDEN = ("script", "link", "iframe", "object", "embed", "form", "base")
SINGLE = ("meta", "img", "br", "path", "circle")  # elements without an end


class Page(html.parser.HTMLParser):
    """What a page says, and what it would fetch."""

    def __init__(self, text):
        super().__init__()
        self.source = text
        self.tags, self.fetched, self.links, self.words, self.open = [], [], [], [], []
        self.feed(text)
        self.close()
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attributes):
        self.tags.append(tag)
        for name, value in attributes:
            if name in ("src", "srcset", "data", "poster", "action"):
                self.fetched.append(value)
            elif name == "href":
                self.links.append(value)
            elif name.startswith("on"):
                self.fetched.append(f"{name}={value}")
        if tag not in SINGLE:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if self.open and self.open[-1] == tag:
            self.open.pop()

    def handle_data(self, data):
        if self.open[-1:] != ["style"]:
            self.words.append(data)

    def faults(self):
        """What keeps the page from standing alone, and elements that are not closed."""
        found = [tag for tag in self.tags if tag in FORBIDDEN]
        found += [one[:60] for one in self.fetched if not one.startswith("data:image/")]
        found += [one for one in self.links if not one.startswith(("#", "http://", "https://"))]
        found += re.findall(r"@import|url\(", self.source)
        return found + self.open
