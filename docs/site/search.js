// Search of the site. That of MkDocs asks a server for its index, so it fails where a page is opened as a file.
(function () {
  const input = document.getElementById("mkdocs-search-query");
  const place = document.getElementById("mkdocs-search-results");
  if (!input || !place) return;

  function load(name, next) {
    const script = document.createElement("script");
    script.src = base_url.replace(/\/$/, "") + "/search/" + name;
    script.onload = next;
    document.head.append(script);
  }

  function start() {
    const sections = new Map(search_data.docs.map((section) => [section.location, section]));
    lunr.tokenizer.separator = /[\s\-'’().,:]+/;
    const index = lunr(function () {
      this.ref("location");
      this.field("title", { boost: 5 });
      this.field("text");
      search_data.docs.forEach((section) => this.add(section));
    });

    function found(words) { // whole words, else parts of names; without the signs of lunr's own language
      const plain = words.replace(/[^\w\s]/g, " ").trim();
      const hits = index.search(plain);
      return hits.length || !plain ? hits : index.search(plain.replace(/\S+/g, "*$&*"));
    }

    function show() {
      const words = input.value.trim();
      const articles = (words.length > 2 ? found(words) : []).map((hit) => {
        const section = sections.get(hit.ref);
        const article = document.createElement("article");
        const link = document.createElement("a");
        link.href = base_url.replace(/\/$/, "") + "/" + section.location;
        link.textContent = section.title;
        const title = document.createElement("h3");
        title.append(link);
        const text = document.createElement("p");
        text.textContent = section.text.slice(0, 200);
        article.append(title, text);
        return article;
      });
      place.replaceChildren(...articles);
      if (words && !articles.length) place.textContent = place.dataset.noResultsText || "No results found";
    }

    input.value = new URLSearchParams(window.location.search).get("q") || "";
    input.addEventListener("input", show);
    show();
  }

  load("lunr.js", () => load("search_index.js", start));
})();
