/* Search where the site is opened as a file: such pages may read no others, so results come without excerpts. */
"use strict";
if (location.protocol === "file:") {
  DOCUMENTATION_OPTIONS.SHOW_SEARCH_SUMMARY = false;
  const WAIT = 4000; // [ms] after which a search that still runs never ends: some browsers keep all from pages of files
  addEventListener("load", () => setTimeout(() => {
    const [title, said] = ["h2", ".search-summary"].map((one) => document.querySelector(`#search-results ${one}`));
    if (!title || !said || said.textContent) return;
    Search.stopPulse();
    title.textContent = "No search in pages that are opened as files";
    said.textContent = "Your browser does not allow it. Run python -m http.server --directory build/site/html and open http://localhost:8000.";
  }, WAIT));
}
