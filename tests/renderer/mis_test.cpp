// Light samples weighed against lobe samples, on the host: weights of the densities that samples have, unbiased where
// they are not filtered, the parts where one kind is missing, and as far off as they say.
#include "renderer/methods/mis.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "renderer/methods/filtered_brdf.h"
#include "renderer/methods/position_dependent.h"
#include "tests/support/deviations.h"
#include "tests/support/sampling_cases.h"

namespace lumifield {
namespace {

using namespace test;

const Case inside_grazing{"grazing", {{6, -4, 40}, Vec3(0.9, 0.2, -0.2).normalized()}};

/// Every kind of mixture: no lobe samples; diffuse ones; glossy ones, weighed and apart.
struct Mixed {
  const char* name;
  Case at;
  Look look;
};
std::vector<Mixed> mixtures() {
  std::vector<Mixed> all{{"diffuse beyond S", beyond, {}},
                         {"diffuse between the planes", between, {}},
                         {"diffuse, grazing", inside_grazing, {}}};
  for (const Case& c : {beyond, near_s, on_s, between}) {
    all.push_back({"GGX 0.3", c, shining(c.receiver, LOBE_GGX, 0.09F)});
    all.push_back({"Phong 50", c, shining(c.receiver, LOBE_PHONG, 50)});
  }
  all.push_back({"GGX 0.7", beyond, shining(beyond.receiver, LOBE_GGX, 0.5F)});
  all.push_back({"GGX 0.1 beside the lamp", beyond, shining(beyond.receiver, LOBE_GGX, 0.01F, {90, 0})});
  return all;
}

std::size_t last_value(const Look& look) { return look.lobe.kind == LOBE_NONE ? 0 : 1; }

double exact(const LightField& field, const Mixed& mixed, std::size_t value) {
  return test::exact(field, mixed.at.receiver, mixed.look, value);
}
Runs runs(const LightField& field, const MethodSettings& settings, const Mixed& mixed, std::size_t value,
          double reference, int seeds) {
  return test::runs(field, settings, mixed.at.receiver, mixed.look, value, reference, seeds);
}

TEST(Mis, WeighsByTheDensitiesThatSamplesHave) {
  const LightField field = sampled_luminaire();
  const LuminaireGeometry& g = field.geometry();
  const Basis basis(g.sampling.basis);
  constexpr double samples = 100;
  const MisCounts counts = mis_counts(samples);
  const Mis form(field, {.method = Method::mis, .samples = samples, .filter = false});
  const std::vector<SampledCell> cells = sampled_cells(field);
  const Look narrow = shining(beyond.receiver, LOBE_GGX, 0.04F);
  for (const auto& [c, look, n, k] : {std::tuple(beyond, narrow, counts.glossy, counts.light_beside),
                                      {between, Look{}, counts.diffuse, counts.light}}) {
    const ReceiverView view(g, basis, c.receiver);
    double all = 0;
    for (const SampledCell& cell : cells) all += BoxDistribution(cell.importance, view.box(cell.u_mm)).integral();
    int both = 0;
    for (const SampledCell& cell : cells)
      for (const Vec2& tau : {Vec2(0.1, -0.3), Vec2(-0.6, 0.2), Vec2(0.7, 0.7)}) {
        const Vec2 u = cell.u_mm + g.sampling.spacing_mm.cwiseProduct(tau), s = view.on_s_px(cell.u_mm, tau);
        const BoxDistribution box(cell.importance, view.box(cell.u_mm));
        const Vec3 to = Vec3(u.x(), u.y(), 0) - c.receiver.p_mm;
        const double on_u = k * box.integral() / all * box.pdf(s.x(), s.y()) * std::abs(view.rate().prod()) /
                            g.sampling.spacing_mm.prod();
        const double q = on_u * std::pow(to.norm(), 3) / c.receiver.p_mm.z();
        const double b = n * LobeDistribution(look.lobe, c.receiver.n).pdf(to.normalized());
        const Mis::Weights w = form.weights(c.receiver, look, g.sampling.index(static_cast<int>(cell.number)), u);
        EXPECT_NEAR(w.light + w.lobes, 1, 1e-12) << c.name;
        EXPECT_NEAR(w.light, q / (q + b), 1e-9) << c.name;
        both += w.light > 0.05 && w.lobes > 0.05;
      }
    EXPECT_GT(both, 3) << c.name;
  }
  // Of what a receiver does not see, neither.
  const Mis::Weights none = form.weights(beyond.receiver, narrow, {0, 0}, {500, 500});
  EXPECT_EQ(none.light + none.lobes, 0);
}

TEST(Mis, FilteredWeightsAreOneTogetherAndChangeSlowly) {
  const LightField field = sampled_luminaire();
  const Mis form(field, {.method = Method::mis, .samples = 100});
  const Look look = shining(beyond.receiver, LOBE_GGX, 0.04F);
  const CellIndex cell{1, 1};
  const Vec2 u_m = field.geometry().sampling.cell_center_mm(cell);
  double before = -1;
  for (double x = -7.9; x < 8; x += 0.1) {
    const Mis::Weights w = form.weights(beyond.receiver, look, cell, u_m + Vec2(x, 0));
    EXPECT_NEAR(w.light + w.lobes, 1, 1e-12);
    if (before >= 0) {
      EXPECT_NEAR(w.light, before, 0.02) << x;
    }
    before = w.light;
  }
}

TEST(Mis, OfAVeryNarrowLobeEachKindMakesOnePart) {
  const LightField field = sampled_luminaire();
  const Look look = shining(beyond.receiver, LOBE_GGX, 0.01F);
  const auto values = [&](Method method, double samples) {
    return make_host_method(field, {.method = method, .samples = samples})
        .value()
        ->light(beyond.receiver, 3, look)
        .value();
  };
  const std::vector<double> mis = values(Method::mis, 80);
  EXPECT_EQ(mis[0], values(Method::position_dependent, 70)[0]);
  const double lobes = values(Method::filtered_brdf, 320)[1];
  EXPECT_GT(lobes, 0);
  EXPECT_NEAR(mis[1], lobes, 1e-12 * lobes);
}

TEST(Mis, IsPositionDependentWhereNoLobeShowsTheLamp) {
  const LightField field = sampled_luminaire();
  const Case far{"far away", {{100, -80, 900}, towards}};
  for (const bool filter : {false, true})
    for (const Look& look :
         {Look{}, shining(far.receiver, LOBE_GGX, 0.5F), shining(far.receiver, LOBE_GGX, 0.01F, {500, 0})}) {
      const auto values = [&](Method method) {
        return make_host_method(field, {.method = method, .samples = 60, .filter = method != Method::mis || filter})
            .value()
            ->light(far.receiver, 3, look)
            .value();
      };
      const std::vector<double> mis = values(Method::mis), lights = values(Method::position_dependent);
      EXPECT_GT(lights[0], 0);
      EXPECT_EQ(mis, lights);
    }
}

TEST(Mis, IsLobeSamplesWhereThereAreNoneOfTheLight) {
  const LightField field = sampled_luminaire();
  for (const bool filter : {false, true})
    for (const Case& c : {beyond, near_s, between}) {
      const Look look = shining(c.receiver, LOBE_GGX, 0.04F);
      const MethodSettings settings{.method = Method::mis, .samples = 40, .filter = filter};
      const double mis = Mis(field, settings, MisCounts{0, 0, 0, 40, 40}).light(c.receiver, 3, look).value()[1];
      const double lobes = FilteredBrdf(field, settings).light(c.receiver, 3, look).value()[1];
      EXPECT_GT(lobes, 0) << c.name;
      EXPECT_NEAR(mis, lobes, 1e-12 * lobes) << c.name;
    }
}

TEST(Mis, UnfilteredIsUnbiased) {
  const LightField field = sampled_luminaire();
  for (const Mixed& mixed : mixtures())
    for (std::size_t value = 0; value <= last_value(mixed.look); ++value) {
      const MethodSettings settings{.method = Method::mis, .samples = 24, .filter = false};
      const Runs all = runs(field, settings, mixed, value, 0, 1000);
      const double reference = exact(field, mixed, value);
      // A lobe's reference is itself a sum of pieces.
      EXPECT_LT(std::abs(all.mean - reference), 3 * all.error + (value > 0 ? 1e-3 * reference : 0))
          << mixed.name << ' ' << mixed.at.name << ' ' << value << ": " << reference;
      EXPECT_LT(all.error, 0.05 * reference) << mixed.name << ' ' << mixed.at.name << ": else nothing is tested";
    }
}

TEST(Mis, IsAsFarOffAsItStates) {
  const LightField field = sampled_luminaire();
  constexpr int seeds = 200;
  const std::vector<Mixed> all_mixtures = mixtures();
  for (std::size_t m = 0; m < all_mixtures.size(); m += 2)
    for (const bool filter : {false, true}) {
      const Mixed& mixed = all_mixtures[m];
      const std::size_t value = last_value(mixed.look);
      const MethodSettings settings{
          .method = Method::mis, .samples = 60, .sequence = PointSequence::twister, .filter = filter};
      const double reference = exact(field, mixed, value);
      const Runs all = runs(field, settings, mixed, value, reference, seeds);
      const double stated = make_host_method(field, settings)
                                .value()
                                ->estimate(mixed.at.receiver, 17, mixed.look)
                                .value()
                                .stated_error[value];
      EXPECT_LT(all.rms, deviation_bound(seeds, 1) * stated) << mixed.name << ' ' << mixed.at.name << filter;
      // The means' squares are no part of the deviation.
      EXPECT_GT(all.rms, 0.3 * stated) << mixed.name << ' ' << mixed.at.name << filter;
    }
}

TEST(Mis, IsNearerThanEitherPartOfAsManySamples) {
  const LightField field = sampled_luminaire();
  for (const Mixed& mixed : mixtures()) {
    const std::size_t value = last_value(mixed.look);
    const double reference = exact(field, mixed, value);
    const auto rms = [&](Method method, double samples) {
      return runs(field, {.method = method, .samples = samples, .filter = method == Method::position_dependent}, mixed,
                  value, reference, 60)
          .rms;
    };
    // 200 rays at most are of each kind.
    EXPECT_LT(rms(Method::mis, 50), 1.1 * rms(Method::position_dependent, 50)) << mixed.name << ' ' << mixed.at.name;
    EXPECT_LT(rms(Method::mis, 50), 1.1 * rms(Method::filtered_brdf, 50)) << mixed.name << ' ' << mixed.at.name;
  }
}

}  // namespace
}  // namespace lumifield
