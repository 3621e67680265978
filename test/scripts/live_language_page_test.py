"""Tests of the words of the pages: one dictionary has them all, in each of its languages."""

import re
import unittest

from browser_case import LiveCase, wait_for
from report_test import Reader
from reporting.packages import PAGE
from reporting.page import render
from spintop_figures.tables.words import dictionary

LANGUAGES = ["en", "de", "fr"]
WORDS = dictionary()
OF_REPORTS = ("account", "comparison", "main", "readout", "viewer", "stage/stage")
SCRIPTS = [*(PAGE / f"{name}.js" for name in ("live_main", "bar", *OF_REPORTS))]
SCRIPTS += sorted((PAGE / "live").glob("*.js"))
SPOKEN = ("aria-label", "alt", "title", "placeholder")
NAMES = {"spintop", "rad"}
"""Words that are not translated: the program, and a unit."""

KEY = re.compile(r'\bsay\("(\w+)"|data-(?:text|label)="(\w+)"|\? "(\w+)" : "(\w+)"')
LETTERS = re.compile(r"[A-Za-z\u00c0-\u017f]{3,}")
LITERAL = re.compile(r'"([^"\n]*)"|`([^`]*)`')
PROSE = re.compile(r"\b[A-Za-z]{2,} [a-z]{2,}\b|\b[A-Z][a-z]+ [a-z]")
CODE = re.compile(r"calc\(|var\(|^\d+px |\\n| = |[_$]\{")

TEXTS = """
    const textsOfPage = () => {
        const found = [document.title], { body } = document;
        const walk = document.createTreeWalker(body, NodeFilter.SHOW_TEXT);
        const own = "script, style, template, noscript, pre, .brand, select.language";
        while (walk.nextNode()) {
            if (!walk.currentNode.parentElement.closest(own)) found.push(walk.currentNode.data);
        }
        for (const name of ["aria-label", "aria-valuetext", "alt"]) {
            const items = [...body.querySelectorAll(`[${name}]`)];
            found.push(...items.map((item) => item.getAttribute(name)));
        }
        const boxes = body.querySelectorAll("section.live input[type=text]");
        return [...found, ...[...boxes].map(({ value }) => value)];
    };
"""
"""All that one reads or hears on the page, but for inputs of the program."""


class DictionaryTest(unittest.TestCase):
    def test_complete(self) -> None:
        """Every key has words in every language, with the same places for values."""
        for key, texts in WORDS.items():
            self.assertEqual(list(texts), LANGUAGES, key)
            places = {frozenset(re.findall(r"\{\w+\}", text)) for text in texts.values()}
            self.assertEqual(len(places), 1, key)
            for text in texts.values():
                self.assertTrue(text.strip(), key)
                self.assertNotRegex(text, r"\d\.\d", key)

    def test_keys(self) -> None:
        """Every key that a script or the page names is in the dictionary."""
        texts = [path.read_text(encoding="utf-8") for path in SCRIPTS]
        found = set()
        for text in [*texts, render("live.html", "")]:
            calls = "\n".join(line for line in text.splitlines() if "say(" in line or "<" in line)
            found |= {key for keys in KEY.findall(calls) for key in keys if key}
        self.assertGreater(len(found), 100)
        self.assertLessEqual(found, set(WORDS))

    def test_templates_have_no_words(self) -> None:
        """A template names its words, and says none."""
        for name in ("live_top", "live", "keys"):
            text = (PAGE / f"{name}.html").read_text(encoding="utf-8")
            reader = Reader(re.sub(r"\{\{.*?\}\}|\{%.*?%\}|>spintop<", "", text, flags=re.DOTALL))
            spoken = [facts.get(key) or "" for _, facts in reader.elements for key in SPOKEN]
            said = [part for part in (reader.text, *spoken) if re.search(r"[A-Za-z]{2}", part)]
            self.assertEqual(said, [], name)

    def test_scripts_have_no_words(self) -> None:
        """A script has no sentence; those of an input, of a style and of a font are none."""
        for path in SCRIPTS:
            for line in path.read_text(encoding="utf-8").splitlines():
                code = re.sub(r"(^|\s)(//|/?\*).*", "", line)
                for literal in ("".join(parts) for parts in LITERAL.findall(code)):
                    if not CODE.search(literal):
                        self.assertNotRegex(literal, PROSE, f"{path.name}: {line}")

    def test_prose_is_found(self) -> None:
        for text in ("The link is copied.", "spin too slow", "Steady precession"):
            self.assertRegex(text, PROSE)


class LanguageTest(LiveCase):
    def texts(self, actions: str = "") -> list[str]:
        """What the page says after some actions, or after each of those that yield."""
        return self.run_script(f"{TEXTS} {actions} return textsOfPage();")

    def strange_words(self, language: str, texts: list[str]) -> set[str]:
        """The words of texts that the dictionary does not have in a language."""
        known = set(LETTERS.findall(" ".join(words[language] for words in WORDS.values())))
        return set(LETTERS.findall(" ".join(texts))) - known - NAMES

    def test_every_word(self) -> None:
        """All presets and two tops say what the dictionary has in German."""
        presets = """
            const found = [];
            for (const { value } of [...liveTop.parts.preset.options]) {
                liveTop.parts.preset.value = value;
                liveTop.parts.preset.dispatchEvent(new Event("change"));
                found.push(...textsOfPage());
            }
            return [...found, ...textsOfPage()];
        """
        self.open(self.page, "?lang=fr#lang=de")
        self.assertEqual(self.run_script("return document.documentElement.lang"), "de")
        self.open(self.page, "?lang=de")
        self.assertEqual(self.run_script("return document.documentElement.lang"), "de")
        texts = self.texts(presets)
        self.assertGreater(len(texts), 2000)
        self.run_script("liveTop.second.keep(true); liveTop.set({ theta: 41 })")
        self.wait_for_text("kept", "θ₀")
        self.assertEqual(self.strange_words("de", texts + self.texts()), set())
        self.assertEqual(self.violations(), [])

    def test_strange_words_are_found(self) -> None:
        self.open(self.page, "#lang=de")
        texts = self.texts("liveTop.parts.class.textContent = 'Steady precession';")
        self.assertEqual(self.strange_words("de", texts), {"Steady", "precession"})

    def test_widths(self) -> None:
        """No page scrolls sideways, no word is broken at random, and the menu covers no title."""
        script = """
            document.querySelectorAll("details").forEach((each) => { each.open = true; });
            const broken = [...document.querySelectorAll(arguments[0])].filter((each) => {
                each.style.overflowWrap = "normal";
                return each.scrollWidth > each.clientWidth;
            });
            const [title, menu] = ["h1", "select.language"].map((name) =>
                document.querySelector(name).getBoundingClientRect());
            const words = broken.map((each) => each.textContent);
            return [document.documentElement.scrollWidth, title.right <= menu.left, words];
        """
        labels = "h1, .control label, .shown label, .facts > *"
        for language in LANGUAGES:
            for width in (360, 390, 412, 1280, 1400):
                with self.subTest(language, width=width):
                    self.set_screen(width, 844)
                    self.open(self.page, f"#lang={language}")
                    self.assertEqual(self.run_script(script, labels), [width, True, []])

    def test_decimal_comma(self) -> None:
        """German and French numbers have a comma, those of the input a point; both are typed."""
        for language, number in (("de", "11,25"), ("fr", "11,25"), ("en", "11.25")):
            with self.subTest(language):
                self.open(self.page, f"#lang={language}")
                self.choose("example1")
                box = self.control("theta", "text")
                self.assertEqual(box.get_property("value"), number)
                wrong = r"\d\.\d" if number == "11,25" else r"\d,\d"
                self.assertEqual([t for t in self.texts() if re.search(wrong, t)], [])
                wait_for(lambda: "theta_deg = 11.25" in self.text("input"), "the input")
        for text in ("12.5\n", "12,5\n"):
            self.type_into(box, text)
            self.assertEqual(self.run_script("return liveTop.state.theta"), 12.5)

    def test_language_of_the_browser(self) -> None:
        """The browser's language is spoken, unless the link or the reader asks for another."""
        agent = self.run_script("return navigator.userAgent")
        command = "Emulation.setUserAgentOverride"
        self.addCleanup(self.tell, command, userAgent=agent, acceptLanguage="en-US")
        self.tell(command, userAgent=agent, acceptLanguage="it-IT,fr-FR,en")
        self.open(self.page)
        self.assertEqual(self.text("preset_words"), WORDS["preset_cusp_words"]["fr"])
        self.choose("wave")
        wait_for(lambda: "phi_rate=0.8" in self.run_script("return location.hash"), "the link")
        self.assertNotIn("lang=", self.run_script("return location.hash"))
        menu = self.browser.find_element("css selector", "select.language")
        menu.find_element("css selector", "[value=de]").click()
        german = WORDS["class_wave"]["de"]
        wait_for(lambda: self.run_script("return liveTop?.parts.class.textContent") == german, "it")
        self.assertEqual(self.part(self.section, "preset").get_property("value"), "wave")
        self.assertIn("lang=de", self.run_script("return location.hash"))
        self.assertEqual(self.browser.title, WORDS["live_top"]["de"] + " \N{EN DASH} spintop")
