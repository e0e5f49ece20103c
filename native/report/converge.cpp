// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/converge.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <map>
#include <set>

#include "film/exr.h"
#include "film/write_file.h"
#include "integrate/cost.h"
#include "integrate/passes.h"
#include "math/error.h"
#include "report/external.h"
#include "report/flip.h"
#include "report/provenance.h"

namespace wardmis {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr uint32_t kReferenceChunks = 8;
constexpr uint32_t kReferenceFactor = 16;        // samples of the reference over those of a run
constexpr uint64_t kReferenceSeed = 0x5eed0000;  // far from the runs'
constexpr double kReferenceShare = 0.25;         // of a budget
constexpr double kFewestSamples = 4;             // of each run, for which a budget must suffice
constexpr size_t kFewestOfBudget = 4;            // seeds, of which it must; it cuts what are more
constexpr double kUsedShare = 0.95;              // of a budget; the rest is for the report
constexpr double kMargin = 1.25;                 // of a time that is said to be enough: speeds vary
constexpr uint32_t kSurveySamples = 16;
constexpr uint32_t kWaySamples = 64;  // of what each way to make a path brings,
constexpr int kWayPixels = 96;        // in images of so many pixels across
constexpr const char* kLayer = "ViewLayer";

void requireFile(const fs::path& path) {
  if (!fs::is_regular_file(path)) throw Error(ExitCode::kFile, path.string() + ": is no file", "remove it");
}

// An object.
json readJson(const fs::path& path) {
  requireFile(path);
  std::ifstream in(path);
  try {
    json j = json::parse(in);
    if (!j.is_object()) throw Error(ExitCode::kFile, path.string() + ": is no JSON object", "delete it");
    return j;
  } catch (const json::exception& e) {
    throw Error(ExitCode::kFile, fmt::format("{}: {}", path.string(), e.what()),
                "the file is damaged; choose another folder, or delete this one");
  }
}

// 0 where there is no such number.
uint32_t countIn(const json& j, const char* key) {
  return j.contains(key) && j[key].is_number_unsigned() ? j[key].get<uint32_t>() : 0;
}

void makeFolder(const fs::path& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    throw Error(ExitCode::kFile, fmt::format("{}: the folder cannot be made: {}", path.string(), error.message()),
                "choose another");
}

// Keeps other processes out of the study.
class FolderLock {
 public:
  explicit FolderLock(const fs::path& folder) : folder_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
    if (folder_ >= 0 && flock(folder_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      close(folder_);
      throw Error(ExitCode::kFile, fmt::format("{}: another process is at work on this study", folder.string()),
                  "wait for it, or choose another folder");
    }
  }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock() {
    if (folder_ >= 0) close(folder_);
  }

 private:
  int folder_;
};

class Study {
 public:
  Study(const BuiltScene& built, const StudyPlan& plan, const StudyObserver& observer)
      : built_(built), plan_(plan), observer_(observer), start_(wallSeconds()) {
    Experiment& e = experiment_;
    e.folder = plan.folder;
    e.title = plan.title;
    e.scene = &built.scene;
    e.built = &built;
    e.width = built.scene.film.x1 - built.scene.film.x0;
    e.height = built.scene.film.y1 - built.scene.film.y0;
    e.configurations = plan.configurations;
    e.target = plan.target;
    e.command = plan.command;
    e.threads = threadsOf(plan.threads);
    e.started = timestamp();
    e.sceneHash = hashOf(built.scene.files);
    for (size_t i = 0; i < plan.seeds; ++i) e.seeds.push_back(plan.firstSeed + i);
  }

  void check() {
    checkNames();
    if (!plan_.reference.empty()) given();
    for (const fs::path& manifest : plan_.external) readManifest(manifest);
    identify(false);
  }

  Experiment run() {
    checkNames();
    // before the runs take their time, and before the folder says what it is a study of
    for (const fs::path& manifest : plan_.external) readManifest(manifest);
    std::optional<Reference> reference;
    if (!plan_.reference.empty()) reference = given();
    identify(false);
    if (maxSpp_ == 0) choose();  // refuses before there is a folder
    makeFolder(plan_.folder);
    const FolderLock lock(plan_.folder);
    identify(true);
    Experiment& e = experiment_;
    for (uint32_t n = 1; n < maxSpp_; n *= 2) e.checkpoints.push_back(n);
    e.checkpoints.push_back(maxSpp_);
    RenderSettings s = e.configurations[e.baseline].settings;
    s.threads = plan_.threads, s.seed = kReferenceSeed - 1, s.spp = std::max(maxSpp_, kSurveySamples);
    for (Configuration& c : e.configurations) describeKernel(c);
    references(std::move(reference));
    if (!stopped()) {
      e.survey = survey(built_, s, kSurveySamples);
      s.spp = std::max(s.spp, 150u);  // three rounds of measuring
      withThreads(s.threads, [&] { e.sampleCost = measureCost(built_, s).sample; });
    }
    for (const Configuration& c : e.configurations) {
      if (stopped()) break;
      RenderSettings own = c.settings;
      own.threads = plan_.threads, own.seed = kReferenceSeed - 1, own.spp = maxSpp_;
      e.ways.push_back(surveyWays(built_, own, kWaySamples, kWayPixels, [&] { return stopped(); }));
    }
    e.runs.resize(e.configurations.size());
    if (!stopped()) runs();
    for (const fs::path& manifest : plan_.external)
      if (!stopped()) addExternal(e, manifest, observer_.warn);
    e.complete = !stopped();
    e.ended = timestamp();
    return std::move(e);
  }

 private:
  bool stopped() const { return observer_.stop != nullptr && observer_.stop->load() != Stop::kNo; }

  void checkNames() {
    Experiment& e = experiment_;
    std::set<std::string> names;
    for (const Configuration& c : e.configurations)
      if (!names.insert(folderName(c.name)).second)
        throw Error(ExitCode::kUsage, fmt::format("two configurations are called '{}'", c.name),
                    "give them names: --configuration NAME:allocation=...");
    if (plan_.baseline.empty()) return;
    const auto found = std::find_if(e.configurations.begin(), e.configurations.end(),
                                    [&](const Configuration& c) { return c.name == plan_.baseline; });
    if (found == e.configurations.end())
      throw Error(ExitCode::kUsage, fmt::format("--baseline '{}' is none of the configurations", plan_.baseline),
                  "name one of them");
    e.baseline = static_cast<size_t>(found - e.configurations.begin());
  }

  // What the folder is a study of, and the number of samples, which a budget decides once.
  void identify(bool write) {
    const Experiment& e = experiment_;
    json configurations = json::object();
    for (const Configuration& c : e.configurations) configurations[c.name] = c.described;
    json identity{{"schema", "wardmis-study-1"},
                  {"version", WARDMIS_VERSION},
                  {"scene", e.sceneHash},
                  {"width", e.width},
                  {"height", e.height},
                  {"configurations", configurations},
                  {"max_spp", plan_.budgetSeconds > 0 ? json() : json(plan_.maxSpp)},
                  {"budget_seconds", plan_.budgetSeconds},
                  {"reference", plan_.reference.empty() ? "" : hashOf({&plan_.reference, 1})},
                  {"reference_seconds", plan_.referenceSeconds},
                  {"first_seed", plan_.firstSeed},
                  {"threads", e.threads}};
    const fs::path path = plan_.folder / "study.json";
    if (fs::exists(path)) {
      const json found = readJson(path);
      for (const auto& [key, value] : identity.items())
        if (!found.contains(key) || found[key] != value)
          throw Error(ExitCode::kUsage,
                      fmt::format("{} holds another study, which differs in '{}'", plan_.folder.string(), key),
                      "choose another folder, or delete this one");
      maxSpp_ = countIn(found, "chosen_spp"), referenceSpp_ = countIn(found, "reference_spp");
      if (maxSpp_ < 2 || referenceSpp_ < 1)
        throw Error(ExitCode::kFile, path.string() + ": does not say how many samples the runs have",
                    "delete the folder, or choose another");
      if (const uint32_t cut = countIn(found, "seeds_of_budget"); cut > 0 && cut < experiment_.seeds.size())
        cutSeeds(cut);
      if (found.contains("started") && found["started"].is_string()) experiment_.started = found["started"];
      return;
    }
    for (const char* left : {"runs", "reference"})
      if (fs::exists(plan_.folder / left))
        throw Error(
            ExitCode::kUsage,
            fmt::format("{} holds '{}' of a study, but no study.json to say of which", plan_.folder.string(), left),
            "choose another folder, or delete this one");
    if (!write) return;
    identity["chosen_spp"] = maxSpp_;
    identity["seeds_of_budget"] = seedsWereCut_ ? json(experiment_.seeds.size()) : json();
    identity["reference_spp"] = referenceSpp_;
    identity["started"] = e.started;
    writeFile(path, identity.dump(2) + '\n');
  }

  // Samples of a run, and of each chunk of the reference.
  void choose() {
    maxSpp_ = plan_.maxSpp;
    referenceSpp_ = std::max(1u, maxSpp_ * kReferenceFactor / kReferenceChunks);
    if (plan_.budgetSeconds <= 0 && plan_.referenceSeconds <= 0) return;
    const double perSample = secondsPerSample();
    const double forReference = !plan_.reference.empty()     ? 0
                                : plan_.referenceSeconds > 0 ? plan_.referenceSeconds
                                                             : kReferenceShare * plan_.budgetSeconds;
    const size_t targets = referenceTargets().size();
    if (plan_.budgetSeconds > 0) {
      // besides the runs: what it took to know this, and what the survey and the costs will
      const double overhead = wallSeconds() - start_ + 2 * kSurveySamples * perSample;
      const double available = kUsedShare * plan_.budgetSeconds - overhead - forReference;
      const double ofASeed = perSample * double(experiment_.configurations.size());  // and a sample
      double affordable = available / (ofASeed * double(experiment_.seeds.size()));
      const size_t fewest = std::min(kFewestOfBudget, experiment_.seeds.size());
      if (affordable < kFewestSamples && available >= kFewestSamples * ofASeed * double(fewest)) {
        cutSeeds(static_cast<size_t>(available / (kFewestSamples * ofASeed)));
        affordable = kFewestSamples;
      }
      const double runs = kFewestSamples * ofASeed * double(fewest);
      const double enough = plan_.reference.empty() && plan_.referenceSeconds <= 0
                                ? (runs + overhead) / (kUsedShare - kReferenceShare)
                                : (runs + overhead + forReference) / kUsedShare;
      if (affordable < kFewestSamples)
        throw Error(
            ExitCode::kUsage,
            fmt::format("--budget-seconds {}: {:.1f} samples per pixel for each of {} runs, after {:.0f} s for "
                        "the reference",
                        plan_.budgetSeconds, std::max(0.0, available / (ofASeed * double(fewest))),
                        experiment_.configurations.size() * fewest, forReference),
            fmt::format("give at least {:.0f} s, or fewer configurations, fewer --seeds or a lower --resolution",
                        std::ceil(kMargin * enough)));
      maxSpp_ = std::bit_floor(static_cast<uint32_t>(std::min(affordable, double(1u << 24))));
      referenceSpp_ = std::max(1u, maxSpp_ * kReferenceFactor / kReferenceChunks);
    }
    if (forReference > 0)
      referenceSpp_ = static_cast<uint32_t>(
          std::clamp(forReference / double(targets) / kReferenceChunks / perSample, 1.0, double(1u << 24)));
  }

  // A budget does not suffice for more.
  void cutSeeds(size_t count) {
    if (observer_.warn)
      observer_.warn(fmt::format("the budget suffices for {} of the {} seeds, at {} samples per pixel each", count,
                                 experiment_.seeds.size(), kFewestSamples));
    experiment_.seeds.resize(count);
    seedsWereCut_ = true;
  }

  // Mean over the configurations; where a budget is used up before all are measured, over those that are: it is too
  // small.
  double secondsPerSample() const {
    double sum = 0;
    size_t measured = 0;
    const auto usedUp = [&] { return plan_.budgetSeconds > 0 && wallSeconds() - start_ > plan_.budgetSeconds; };
    for (const Configuration& c : experiment_.configurations) {
      RenderSettings s = c.settings;
      s.spp = 8, s.seed = kReferenceSeed - 2, s.threads = plan_.threads;
      RenderObserver watch;
      watch.stop = observer_.stop;
      double seconds = 0;
      for (int round = 0; round < (sum > 0 ? 1 : 2) && (round == 0 || !usedUp());
           ++round) {  // the first warms the caches
        Statistics st;
        const FilmBuffer film = render(built_, s, st, watch);
        seconds = (st.pilotSeconds + st.renderSeconds) / std::max(1u, film.samples);
      }
      // whose runs render each checkpoint anew: 1 + 2 + ... + n samples
      sum += c.settings.sampler == SamplerType::kStratified ? 2 * seconds : seconds;
      ++measured;
      if (usedUp()) break;
    }
    return std::max(sum / double(measured), 1e-9);
  }

  // The settings of one configuration for each kind of light that is estimated.
  std::map<std::string, RenderSettings> referenceTargets() const {
    std::map<std::string, RenderSettings> targets;
    for (const Configuration& c : experiment_.configurations) {
      const auto [found, isNew] = targets.emplace(estimates(c.settings), c.settings);
      // of those that estimate the same, one with paths from the lights: where they are wanted, the camera's alone
      // would leave the reference the noise that is measured
      if (!isNew && c.settings.bidirectional() && !found->second.bidirectional()) found->second = c.settings;
    }
    return targets;
  }

  void describeKernel(Configuration& c) const {
    c.kernel = describe(kernelNeeds(built_, c.settings));
    c.leftOut = leftOut(built_, c.settings);
  }

  void references(std::optional<Reference> given) {
    Experiment& e = experiment_;
    std::vector<std::string> order;  // the baseline's first
    order.push_back(estimates(e.configurations[e.baseline].settings));
    for (const Configuration& c : e.configurations)
      if (const std::string k = estimates(c.settings); std::find(order.begin(), order.end(), k) == order.end())
        order.push_back(k);
    const auto targets = referenceTargets();
    for (const std::string& key : order) {
      if (stopped()) return;
      if (given) {
        given->estimates = key;
        e.references.push_back(std::move(*given));
        if (order.size() > 1 && observer_.warn)
          observer_.warn(
              "the configurations estimate different light, and all are held against the one reference given");
        break;
      }
      makeReference(key, targets.at(key), e.references.size());
    }
    for (Configuration& c : e.configurations) {
      const auto k = std::find(order.begin(), order.end(), estimates(c.settings));
      c.reference = plan_.reference.empty() ? static_cast<size_t>(k - order.begin()) : 0;
    }
  }

  // A render of ours says how it was made, and how sure it is.
  void useWhatItSays(Reference& r) const {
    const ExrImage exr = readExr(r.path);
    json settings = json::object();
    for (const auto& [name, text] : exr.attributes) {
      if (name == "wardmis:settings") settings = json::parse(text, nullptr, false);
      if (name == "wardmis:samples_per_pixel") std::from_chars(text.data(), text.data() + text.size(), r.spp);
    }
    const std::vector<uint64_t>& seeds = experiment_.seeds;
    if (settings.is_object() && settings.contains("seed") && settings["seed"].is_number_unsigned() &&
        std::find(seeds.begin(), seeds.end(), settings["seed"].get<uint64_t>()) != seeds.end())
      throw Error(ExitCode::kUsage,
                  fmt::format("{} has the seed {}, as one of the runs: its noise would be theirs", r.path.string(),
                              settings["seed"].dump()),
                  "begin with another --seed");
    std::vector<float> variance(r.image.rgb.size());
    for (size_t c = 0; c < 3; ++c) {
      const std::vector<float>* v = exr.channel(fmt::format("{}.Variance.{}", kLayer, "RGB"[c]));
      if (v == nullptr) return;
      for (size_t i = 0; i < v->size(); ++i) variance[3 * i + c] = (*v)[i];
    }
    r.setVariance(std::move(variance));
    if (!settings.is_object() || settings.value("sampler", "independent") == "independent") return;
    r.mseFloor = r.relMseFloor = r.trimmedFloor =
        0;  // an upper bound is not what may be subtracted; the test of bias is the more careful for it
    if (observer_.warn)
      observer_.warn(
          fmt::format("{} was rendered with evenly spread points, for which its Variance pass is an upper bound: "
                      "its own noise is not subtracted",
                      r.path.string()));
  }

  Reference given() const {
    Reference r;
    r.path = plan_.reference;
    r.image = readRgb(plan_.reference);
    if (r.image.width != experiment_.width || r.image.height != experiment_.height)
      throw Error(ExitCode::kUsage,
                  fmt::format("{} has {} x {} pixels, the render {} x {}", plan_.reference.string(), r.image.width,
                              r.image.height, experiment_.width, experiment_.height),
                  "render the reference at the same resolution and border");
    if (plan_.reference.extension() == ".exr") useWhatItSays(r);
    if (!r.known() && observer_.warn)
      observer_.warn(fmt::format("{} has no Variance pass: its own noise is unknown and is not subtracted",
                                 plan_.reference.string()));
    return r;
  }

  // An image that an earlier start has left, of the study's size and with a Combined pass: nothing, if it is not whole.
  std::optional<ExrImage> whole(const fs::path& path) const {
    if (!fs::exists(path)) return {};
    requireFile(path);
    try {
      ExrImage image = readExr(path);
      if (image.width == experiment_.width && image.height == experiment_.height) {
        rgbOf(image, path);
        return image;
      }
    } catch (const Error&) {
    }
    return {};
  }

  std::optional<ExrImage> chunkOf(const fs::path& path) const {
    std::optional<ExrImage> image = whole(path);
    if (!image && fs::exists(path) && observer_.warn)
      observer_.warn(path.string() + " is damaged; that part of the reference is rendered again");
    return image;
  }

  void makeReference(const std::string& key, RenderSettings s, size_t index) {
    const std::string suffix = index == 0 ? "" : fmt::format("-{}", index + 1);
    const fs::path folder = plan_.folder / ("reference" + suffix),
                   path = plan_.folder / ("reference" + suffix + ".exr");
    makeFolder(folder);
    s.allocation = Allocation::kEqual;
    s.pixels = PixelSamples::kEven;
    s.weights.reset();
    s.sampler = SamplerType::kSobol;
    s.spp = referenceSpp_;
    s.threads = plan_.threads;
    Reference r;
    r.estimates = key, r.path = path, r.made = true, r.spp = referenceSpp_ * kReferenceChunks;
    r.chunks = kReferenceChunks;
    ImageMean mean;
    for (uint32_t k = 0; k < kReferenceChunks; ++k) {
      const fs::path chunk = folder / fmt::format("chunk-{}.exr", k + 1);
      std::optional<ExrImage> found = chunkOf(chunk);
      if (!found) {
        s.seed = kReferenceSeed + k;
        Statistics st;
        RenderObserver watch;
        watch.stop = observer_.stop;
        watch.progress = [&](const Progress& p) {
          const double done = (k + p.fraction) / kReferenceChunks, spent = wallSeconds() - start_;
          tell({"reference", "", k + 1, k, kReferenceChunks, kReferenceShare * done, spent,
                expectedLeft(kReferenceShare * done, spent)});
        };
        const FilmBuffer film = render(built_, s, st, watch);
        if (stopped()) return;
        ExrImage image = toPasses(film, {{"Combined", "RGBA", "combined"}}, {}, kLayer, built_.scene.zUp);
        image.attributes.emplace_back("wardmis:seconds", fmt::format("{}", st.pilotSeconds + st.renderSeconds));
        writeExr(chunk, image, true);
        found = readExr(chunk);
      }
      for (const auto& [name, value] : found->attributes)
        if (name == "wardmis:seconds") r.seconds += std::atof(value.c_str());
      mean.add(rgbOf(*found, chunk));
    }
    r.image = mean.mean();
    r.setVariance(mean.variance());
    // again at every start: what is read by others must not stay damaged
    ExrImage out{r.image.width, r.image.height, {}, {}};
    for (const auto& [pass, values] : {std::pair{"Combined", &r.image.rgb}, std::pair{"Variance", &r.variance}})
      for (size_t c = 0; c < 3; ++c) {
        ExrChannel channel{fmt::format("{}.{}.{}", kLayer, pass, "RGB"[c]), std::vector<float>(r.image.pixels())};
        for (size_t i = 0; i < r.image.pixels(); ++i) channel.values[i] = (*values)[3 * i + c];
        out.channels.push_back(std::move(channel));
      }
    writeExr(path, out, true);
    experiment_.references.push_back(std::move(r));
  }

  void runs() {
    Experiment& e = experiment_;
    struct Job {
      size_t configuration, seed;
    };
    std::vector<Job> jobs;  // ABCCBA: a machine that slowly changes meets all alike
    for (size_t s = 0; s < e.seeds.size(); ++s)
      for (size_t k = 0; k < e.configurations.size(); ++k)
        jobs.push_back({s % 2 == 0 ? k : e.configurations.size() - 1 - k, s});
    const double spentBefore = wallSeconds() - start_;
    size_t fresh = 0;
    for (size_t j = 0; j < jobs.size() && !stopped(); ++j) {
      Configuration& c = e.configurations[jobs[j].configuration];
      const uint64_t seed = e.seeds[jobs[j].seed];
      const fs::path folder = plan_.folder / "runs" / folderName(c.name);
      makeFolder(folder);
      const fs::path file = folder / fmt::format("seed-{:04}.json", seed);
      Run run;
      if (std::optional<Run> earlier = finished(file, seed)) {
        run = std::move(*earlier);
      } else {
        const auto tellRun = [&](double part) {
          const double done = (double(j) + part) / double(jobs.size()), spent = wallSeconds() - start_;
          const double perJob = (spent - spentBefore) / std::max(0.5, double(fresh) + part);
          tell({"runs", c.name, seed, j, jobs.size(), kReferenceShare + (0.98 - kReferenceShare) * done, spent,
                perJob * (double(jobs.size() - j) - part)});
        };
        tellRun(0);
        if (!measureRun(c, seed, file, run, tellRun)) return;
        ++fresh;
      }
      e.runs[jobs[j].configuration].push_back(std::move(run));
    }
    for (std::vector<Run>& r : e.runs)
      std::sort(r.begin(), r.end(), [](const Run& a, const Run& b) { return a.seed < b.seed; });
  }

  // What an earlier start has left of a run: nothing, if it is not whole. Throws where it is another study's.
  std::optional<Run> finished(const fs::path& file, uint64_t seed) const {
    const fs::path image = fs::path(file).replace_extension(".exr");
    if (!fs::exists(file) || !fs::exists(image)) return {};
    const auto damaged = [&](const fs::path& which) -> std::optional<Run> {
      if (observer_.warn) observer_.warn(which.string() + " is damaged; the run is done again");
      return {};
    };
    requireFile(file);
    try {
      std::ifstream in(file);
      Run run = runFromJson(json::parse(in));
      std::vector<uint32_t> spp;
      for (const Checkpoint& c : run.checkpoints) spp.push_back(c.spp);
      if (spp != experiment_.checkpoints || run.seed != seed)
        throw Error(ExitCode::kFile, fmt::format("{}: is not what a run of this study has measured", file.string()),
                    "delete the file, and go on");
      if (!whole(image)) return damaged(image);
      run.image = image;
      return run;
    } catch (const json::exception&) {
      return damaged(file);
    } catch (const std::domain_error&) {
      return damaged(file);
    }
  }

  bool measureRun(Configuration& c, uint64_t seed, const fs::path& file, Run& run,
                  const std::function<void(double)>& told) {
    RenderSettings s = c.settings;
    s.seed = seed, s.threads = plan_.threads, s.spp = maxSpp_;
    run.seed = seed;
    run.calibration = calibrate();
    run.load = loadAverage();
    const RgbImage& reference = experiment_.references[c.reference].image;
    const auto record = [&](const FilmBuffer& film, const Clocks& time, const Counts& n) {
      Checkpoint at;
      at.spp = film.samples, at.time = time;
      at.error = compareImages(toRgb(film), reference);
      at.cameraRays = n.cameraRays;
      at.rays = n.allRays();
      run.checkpoints.push_back(at);
    };
    RenderObserver watch;
    watch.stop = observer_.stop;
    watch.progress = [&](const Progress& p) { told(p.fraction * s.spp / maxSpp_); };
    Statistics st;
    FilmBuffer film;
    if (s.sampler == SamplerType::kStratified) {  // strata are of all samples: each checkpoint is a render of its own
      for (const uint32_t n : experiment_.checkpoints) {
        s.spp = n;
        st = {};
        film = render(built_, s, st, watch);
        if (stopped()) return false;
        record(film, {st.pilotSeconds + st.renderSeconds, st.pilotCpuSeconds + st.renderCpuSeconds}, st.counts);
      }
    } else {
      watch.checkpoint = record;
      film = render(built_, s, st, watch);
      if (stopped()) return false;
    }
    run.pilotSeconds = st.pilotSeconds;
    run.counts = st.counts;
    run.image = fs::path(file).replace_extension(".exr");
    std::vector<PassInfo> passes;
    for (const PassInfo& p : passesFor(st.techniques, st.techniqueNames))
      if (p.group == "combined" || p.group == "variance" || p.group == "allocation") passes.push_back(p);
    const ExrImage image = toPasses(film, passes, st.techniqueNames, kLayer, built_.scene.zUp);
    run.flip = flipError(rgbOf(image, run.image), reference);
    writeExr(run.image, image, true);
    writeFile(file, toJson(run).dump(2) + '\n');  // last: a run without it is done again
    return true;
  }

  void tell(const StudyProgress& p) {
    if (observer_.progress) observer_.progress(p);
  }
  static double expectedLeft(double fraction, double spent) {
    return fraction > 0 ? spent * (1 - fraction) / fraction : 0;
  }

  const BuiltScene& built_;
  const StudyPlan& plan_;
  const StudyObserver observer_;
  Experiment experiment_;
  uint32_t maxSpp_ = 0, referenceSpp_ = 0;
  bool seedsWereCut_ = false;
  double start_;
};

}  // namespace

void check(const BuiltScene& built, const StudyPlan& plan) { Study(built, plan, {}).check(); }

Experiment measure(const BuiltScene& built, const StudyPlan& plan, const StudyObserver& observer) {
  return Study(built, plan, observer).run();
}

}  // namespace wardmis
