// The words of the live top in the languages of its dictionary.

import { setDecimalMark } from "../text.js";
import dictionary from "../../../../python/spintop_figures/tables/dictionary.json";

/** The languages of the dictionary, by their own names. */
export const LANGUAGES = { en: "English", de: "Deutsch", fr: "Français" };
const KEY = "lang"; // of the link

let language = globalThis.document?.documentElement.lang || "en"; // of a report
let isAsked = false; // whether the link asks for it

/** Speak the language that an address asks for, behind # or ?, else the first that the reader's browser knows. */
export function chooseLanguage({ hash, search }) {
  const asked = new URLSearchParams(`${hash}&${search}`.replaceAll(/[#?]/g, "")).get(KEY);
  isAsked = Object.hasOwn(LANGUAGES, asked ?? "");
  const wanted = navigator.languages.map((tag) => tag.slice(0, 2).toLowerCase());
  speak(isAsked ? asked : wanted.find((code) => Object.hasOwn(LANGUAGES, code)) ?? "en");
}

setDecimalMark(language === "en" ? "." : ",");

function speak(code) {
  language = code;
  setDecimalMark(code === "en" ? "." : ",");
  document.documentElement.lang = code;
}

/** The language that is spoken. */
export const spoken = () => language;

/** What a link needs to ask for a language: that of its own, or another. */
export function linkOfLanguage(code = isAsked ? language : "") {
  return code && `${KEY}=${code}`;
}

/** The words of a key of the dictionary, with values in the places of their {names}. */
export function say(key, values = {}) {
  return dictionary[key][language].replace(/\{(\w+)\}/g, (_, name) => values[name]);
}

/** Write the words of an element and of all in it: `data-text` names its text, `data-label` its aria-label or alt. */
export function fillWords(element) {
  for (const item of element.querySelectorAll("[data-text]")) item.textContent = say(item.dataset.text);
  for (const item of element.querySelectorAll("[data-label]")) {
    item.setAttribute(item.localName === "img" ? "alt" : "aria-label", say(item.dataset.label));
  }
}
